(function () {
  "use strict";
  const data = JSON.parse(document.getElementById("states").textContent);
  const slider = document.getElementById("force");
  const label = document.getElementById("force-label");
  let BLUE, VERMILION, GREY, INK, SOFT;

  const panels = data.panels.map(function (panel, index) {
    return {
      data: panel,
      canvas: document.getElementById("panel-" + index),
      note: document.getElementById("note-" + index),
      frames: panel.frames.map(function (text) {
        return Uint8Array.from(atob(text), function (c) { return c.charCodeAt(0); });
      }),
    };
  });

  let top = 0, bottom = 0;
  data.panels.forEach(function (panel) {
    panel.responses.forEach(function (response) {
      response.forEach(function (value, k) {
        if (Math.abs(panel.x[k]) <= data.reach) { top = Math.max(top, value); bottom = Math.min(bottom, value); }
      });
    });
  });
  top = Math.ceil(top * 50) / 50;

  function draw(panel, index) {
    const canvas = panel.canvas, shown = panel.data;
    const width = canvas.clientWidth, scale = width / (2 * data.reach + 2);
    const network = (shown.height + 4.5) * scale, profile = Math.max(110, 0.42 * width);
    const height = network + profile + 34, ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = height + "px";
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.clearRect(0, 0, width, height);
    const X = function (x) { return (x + data.reach + 1) * scale; };
    const Z = function (z) { return network - z * scale; };
    const lines = shown.lines, levels = panel.frames[index];
    let opened = 0;

    pen.strokeStyle = GREY;
    pen.lineWidth = 1;
    pen.beginPath();
    for (let k = 0; k < levels.length; k++) {
      const x = X(lines[4 * k] / 10), z = Z(lines[4 * k + 1] / 10);
      pen.moveTo(x + scale, z);
      pen.arc(x, z, scale, 0, 2 * Math.PI);
    }
    pen.stroke();

    pen.lineCap = "round";
    for (let k = 0; k < levels.length; k++) {
      const level = levels[k];
      if (level === data.opened) {
        opened += 1;
        pen.strokeStyle = VERMILION;
        pen.lineWidth = Math.max(1.6, 0.28 * scale);
      } else {
        const part = (level / data.full) * (level / data.full);
        if (part < 0.004) { continue; }
        pen.strokeStyle = BLUE;
        pen.lineWidth = 2.2 * scale * part;
      }
      pen.beginPath();
      pen.moveTo(X(lines[4 * k] / 10), Z(lines[4 * k + 1] / 10));
      pen.lineTo(X(lines[4 * k + 2] / 10), Z(lines[4 * k + 3] / 10));
      pen.stroke();
    }

    pen.strokeStyle = INK;
    pen.fillStyle = INK;
    pen.lineWidth = 1.4;
    pen.beginPath();
    pen.moveTo(0, Z(0));
    pen.lineTo(width, Z(0));
    pen.moveTo(X(0), Z(shown.height + 4.2));
    pen.lineTo(X(0), Z(shown.height + 1));
    pen.stroke();
    pen.beginPath();
    pen.moveTo(X(0), Z(shown.height + 0.1));
    pen.lineTo(X(-0.9), Z(shown.height + 1.7));
    pen.lineTo(X(0.9), Z(shown.height + 1.7));
    pen.fill();

    const start = network + 14;
    const Y = function (value) { return start + (top - value) / (top - bottom) * profile; };
    pen.font = "11px system-ui, sans-serif";
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "left";
    for (let value = 0; value < top - 1e-9; value += 0.02) {
      pen.strokeStyle = value ? GREY : SOFT;
      pen.beginPath();
      pen.moveTo(0, Y(value));
      pen.lineTo(width, Y(value));
      pen.stroke();
      if (value) { pen.fillStyle = SOFT; pen.fillText(value.toFixed(2), 0, Y(value) - 7); }
    }
    pen.textAlign = "center";
    pen.fillStyle = SOFT;
    [-20, -10, 0, 10, 20].forEach(function (x) {
      pen.fillText(String(x).replace("-", "\u2212"), X(x), start + profile + 11);
    });
    pen.textAlign = "right";
    pen.fillText("x/R", width, start + profile + 11);
    pen.strokeStyle = BLUE;
    pen.fillStyle = BLUE;
    pen.lineWidth = 1.8;
    pen.beginPath();
    const response = shown.responses[index];
    let begun = false;
    shown.x.forEach(function (x, k) {
      if (Math.abs(x) > data.reach + 0.5) { return; }
      if (begun) { pen.lineTo(X(x), Y(response[k])); } else { pen.moveTo(X(x), Y(response[k])); begun = true; }
    });
    pen.stroke();
    shown.x.forEach(function (x, k) {
      if (Math.abs(x) > data.reach + 0.5) { return; }
      pen.beginPath();
      pen.arc(X(x), Y(response[k]), 2, 0, 2 * Math.PI);
      pen.fill();
    });
    const peaks = shown.peaks[index];
    panel.note.textContent = opened + (opened === 1 ? " contact" : " contacts") + " opened, " +
      peaks + (peaks === 1 ? " peak" : " peaks");
  }

  function show() {
    const style = window.getComputedStyle(document.documentElement);
    [BLUE, VERMILION, GREY, INK, SOFT] = ["curve", "opened", "grid", "ink", "soft"].map(function (name) {
      return style.getPropertyValue("--" + name).trim();
    });
    const index = Number(slider.value);
    label.textContent = "F = " + data.forces[index] + " mg";
    slider.setAttribute("aria-valuetext", label.textContent);
    panels.forEach(function (panel) { draw(panel, index); });
  }

  let waiting = 0;
  window.addEventListener("resize", function () {
    window.cancelAnimationFrame(waiting);
    waiting = window.requestAnimationFrame(show);
  });
  slider.addEventListener("input", show);
  // print is light whatever the screen is
  ["(prefers-color-scheme: dark)", "print"].forEach(function (medium) {
    window.matchMedia(medium).addEventListener("change", show);
  });
  show();
})();
