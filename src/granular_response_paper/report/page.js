(function () {
  "use strict";
  // a picture is enlarged by a click
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
      shown.className = picture.className;
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

  // a link into something folded unfolds it
  function unfold(hash) {
    const filter = hash.startsWith("#only-") && document.getElementById(hash.slice(1));
    if (filter) { filter.checked = true; return; }
    const target = document.getElementById(decodeURIComponent(hash.slice(1)));
    const folded = target && target.closest("details:not([open])");
    if (folded) { folded.open = true; target.scrollIntoView(); }
  }
  document.addEventListener("click", function (event) {
    const link = event.target.closest("a[href^='#']");
    if (link) { unfold(link.hash); }
  });
  window.addEventListener("hashchange", function () { unfold(window.location.hash); });
  unfold(window.location.hash);

  // claims that hold all words of the search, in any part of them
  const search = document.getElementById("search");
  if (search) {
    const rows = Array.from(document.querySelectorAll("tr.claim"));
    const texts = rows.map(function (row) { return row.textContent.toLowerCase(); });
    search.addEventListener("input", function () {
      const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
      rows.forEach(function (row, k) { row.hidden = !words.every(function (word) { return texts[k].includes(word); }); });
      document.getElementById("matches").textContent = rows.filter(function (row) { return !row.hidden; }).length + " shown";
    });
  }
})();
