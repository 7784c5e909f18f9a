(function () {
  "use strict";
  const large = document.createElement("dialog");
  large.className = "large";
  large.setAttribute("aria-label", "Enlarged picture");
  const close = document.createElement("button");
  close.textContent = "Close";
  const shown = document.createElement("img");
  large.append(close, shown);
  document.body.append(large);
  large.addEventListener("click", function () { large.close(); });

  document.querySelectorAll(".picture img").forEach(function (picture) {
    const open = function () {
      shown.src = picture.src;
      shown.alt = picture.alt;
      large.showModal();
    };
    picture.tabIndex = 0;
    picture.setAttribute("role", "button");
    picture.setAttribute("aria-label", picture.alt + " Enlarge.");
    picture.addEventListener("click", open);
    picture.addEventListener("keydown", function (event) {
      if (event.key === "Enter" || event.key === " ") { event.preventDefault(); open(); }
    });
  });
})();
