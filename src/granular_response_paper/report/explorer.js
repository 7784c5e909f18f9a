(async function () {
  "use strict";
  const data = JSON.parse(document.getElementById("states").textContent);
  const byId = function (id) { return document.getElementById(id); };
  const slider = byId("force"), label = byId("force-label"), said = byId("said"), marks = byId("marks");
  const typed = function (value) { return String(value).replace("-", "\u2212"); };
  const short = function (value) { return typed(Number(value.toPrecision(2))); };

  try {
    const zipped = Uint8Array.from(atob(data.packed), function (c) { return c.charCodeAt(0); });
    const stream = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = await new Response(stream).arrayBuffer();
    let start = 0;
    data.slabs.forEach(function (slab) {
      const count = slab.contacts, mask = Math.ceil(count / 8), view = new DataView(bytes, start, 8 * count);
      slab.lines = Array.from({length: 4 * count}, function (_, k) { return view.getInt16(2 * k, true) / 10; });
      start += 8 * count;
      slab.frames = slab.forces.map(function () {
        const levels = new Int8Array(bytes, start, count), sliding = new Uint8Array(bytes, start + count, mask);
        start += count + mask;
        return {levels: levels, sliding: function (k) { return (sliding[k >> 3] >> (7 - (k & 7))) & 1; }};
      });
    });
  } catch (error) {
    byId("explorer").textContent = "This browser cannot unpack the states; figures 3 to 9 show them at chosen forces.";
    return;
  }

  const colour = {};
  function readColours() {
    const style = window.getComputedStyle(document.documentElement);
    ["increased", "decreased", "opened", "sliding", "load", "grid", "ink", "soft", "paper"].forEach(function (name) {
      colour[name] = style.getPropertyValue("--" + name).trim();
    });
  }

  function chosen(name) { return Number(document.querySelector("input[name=" + name + "]:checked").value); }

  let slab, wanted = 20;
  function select() {
    const friction = chosen("friction");
    slab = data.slabs.find(function (one) { return one.friction === friction; });
    slider.max = slab.forces.length - 1;
    slider.value = nearest(wanted);
    byId("about").innerHTML = "Shown: " + slab.about_set + ".";
    mark();
    show();
  }
  function nearest(force) {
    let best = 0;
    slab.forces.forEach(function (value, k) {
      if (Math.abs(Math.log(value / force)) < Math.abs(Math.log(slab.forces[best] / force))) { best = k; }
    });
    return best;
  }

  // what the paper names, on the slider and as buttons that go there
  function mark() {
    marks.textContent = "";
    const list = byId("paper");
    list.textContent = slab.paper.length ? "In the paper:" : "The paper names no force for this slab.";
    slab.paper.forEach(function (one) {
      const forces = slab.forces, after = Math.max(1, forces.findIndex(function (f) { return f >= one.force; }));
      const part = Math.log(one.force / forces[after - 1]) / Math.log(forces[after] / forces[after - 1]);
      const tick = document.createElement("i"), place = (after - 1 + part) / (forces.length - 1);
      tick.style.left = "calc(" + 100 * place + "% + " + (0.5 - place) + "rem)";
      marks.append(tick);
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = one.force + " mg: " + one.what + " (" + one.place + (one.here ? "; here " + one.here : "") + ")";
      button.addEventListener("click", function () { stop(); slider.value = nearest(one.force); moved(); });
      list.append(" ", button);
    });
  }

  // what is drawn, by panel: place and value, which is shown beside the pointer
  const spots = {}, value = byId("value");
  ["network", "floor", "range", "phase"].forEach(function (id) {
    byId(id).addEventListener("mousemove", function (event) {
      const away = function (spot) { return Math.hypot(spot[0] - event.offsetX, spot[1] - event.offsetY); };
      const near = spots[id].reduce(function (a, b) { return away(b) < away(a) ? b : a; });
      value.hidden = away(near) > 16;
      value.textContent = near[2];
      value.style.top = event.clientY + 14 + "px";
      value.style.left = Math.min(event.clientX + 10, document.documentElement.clientWidth - value.offsetWidth - 4) + "px";
    });
    byId(id).addEventListener("mouseleave", function () { value.hidden = true; });
  });

  function sheet(id, height) {
    spots[id] = [];
    const canvas = byId(id), width = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height(width) * ratio);
    canvas.style.height = height(width) + "px";
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = "11px system-ui, sans-serif";
    pen.textBaseline = "middle";
    pen.lineJoin = "round";
    return {canvas: canvas, pen: pen, width: width, height: height(width)};
  }
  function text(pen, words, x, y, align, ink) {
    pen.fillStyle = ink || colour.soft;
    pen.textAlign = align;
    pen.fillText(words, x, y);
  }
  function bold(pen, words, x, y, align, ink) {  // what is to be seen in a plot
    pen.font = "bold 13px system-ui, sans-serif";
    text(pen, words, x, y, align, ink);
    pen.font = "11px system-ui, sans-serif";
  }
  function line(pen, points, ink, width, dashes) {
    pen.strokeStyle = ink;
    pen.lineWidth = width;
    pen.setLineDash(dashes || []);
    pen.beginPath();
    points.forEach(function (point, k) { if (k) { pen.lineTo(point[0], point[1]); } else { pen.moveTo(point[0], point[1]); } });
    pen.stroke();
    pen.setLineDash([]);
  }
  function dot(pen, x, y, radius, ink, hollow) {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = hollow ? colour.paper : ink;
    pen.fill();
    if (hollow) { pen.strokeStyle = ink; pen.lineWidth = 1.3; pen.stroke(); }
  }

  const LEFT = 50;
  function across(width) {  // the same x axis for contacts and floor
    const scale = (width - LEFT) / (2 * data.reach + 2);
    return {scale: scale, X: function (x) { return LEFT + (x + data.reach + 1) * scale; }};
  }

  function contacts(index) {
    const place = across(byId("network").clientWidth), scale = place.scale, X = place.X;
    const paper = sheet("network", function () { return (slab.height + 5.5) * scale + 34; });
    const pen = paper.pen, frame = slab.frames[index], lines = slab.lines, floor = paper.height - 32;
    const Z = function (z) { return floor - z * scale; }, high = 12;
    const counts = {opened: 0, sliding: 0, most: 0, least: 0};  // of the contacts that are shown
    pen.strokeStyle = colour.grid;
    pen.lineWidth = 1;
    pen.beginPath();
    const seen = {};
    for (let k = 0; k < 2 * slab.contacts; k++) {
      const x = lines[2 * k], z = lines[2 * k + 1];
      if (seen[x + " " + z]) { continue; }
      seen[x + " " + z] = true;
      pen.moveTo(X(x) + scale, Z(z));
      pen.arc(X(x), Z(z), scale, 0, 2 * Math.PI);
    }
    pen.stroke();
    const widest = 2.2 * scale / data.strongest;
    const order = Array.from(frame.levels.keys()).sort(function (a, b) { return Math.abs(frame.levels[a]) - Math.abs(frame.levels[b]); });
    order.forEach(function (k) {
      const level = frame.levels[k], sliding = frame.sliding(k), ends = [[X(lines[4 * k]), Z(lines[4 * k + 1])], [X(lines[4 * k + 2]), Z(lines[4 * k + 3])]];
      const middle = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2];
      if (level === data.opened) {
        counts.opened += 1;
        spots.network.push([middle[0], middle[1], "opened"]);
        pen.lineCap = "butt";
        line(pen, ends, colour.opened, Math.max(2.2, 0.45 * scale));
      } else {
        const part = data.strongest * (level / data.full) * (level / data.full), width = widest * part;
        spots.network.push([middle[0], middle[1], (level < 0 ? "\u2212" : "+") + short(part) + " F" + (sliding ? ", at the Coulomb limit" : "")]);
        if (level > 0) { counts.most = Math.max(counts.most, part); } else { counts.least = Math.max(counts.least, part); }
        if (part >= 0.008) {
          pen.lineCap = "round";
          pen.globalAlpha = Math.min(1, width / 0.6);  // the thinnest are paler, as a printer would make them wider
          line(pen, ends, level > 0 ? colour.increased : colour.decreased, Math.max(width, 0.6));
          pen.globalAlpha = 1;
        }
      }
      if (sliding) {
        counts.sliding += 1;
        pen.lineCap = "butt";
        line(pen, ends, colour.sliding, Math.max(1.2, 0.16 * scale));
      }
    });
    line(pen, [[LEFT, Z(0)], [paper.width, Z(0)]], colour.ink, 1.4);
    line(pen, [[X(0), Z(slab.height + 4.6)], [X(0), Z(slab.height + 1.4)]], colour.load, 1.6);
    pen.fillStyle = colour.load;
    pen.beginPath();
    pen.moveTo(X(0), Z(slab.height + 0.1));
    pen.lineTo(X(-0.9), Z(slab.height + 1.8));
    pen.lineTo(X(0.9), Z(slab.height + 1.8));
    pen.fill();
    text(pen, "F", X(1.4), Z(slab.height + 3.6), "left", colour.load);
    bold(pen, counts.opened + " opened", paper.width, high, "right", colour.opened);
    const bar = LEFT + 4;  // a bar as wide as half of the applied force
    line(pen, [[bar, high], [bar + 3 * scale, high]], colour.increased, 0.5 * widest);
    text(pen, "0.5 F", bar + 3 * scale + 5, high, "left");
    [0, 10, 20].forEach(function (z) { text(pen, String(z), LEFT - 4, Z(z), "right"); });
    upright(pen, "z/R\u0304", Z(10));
    xTicks(pen, X, floor + 12, paper.width);
    return counts;
  }
  function upright(pen, words, y) {  // along the y axis
    pen.save();
    pen.translate(9, y);
    pen.rotate(-Math.PI / 2);
    text(pen, words, 0, 0, "center");
    pen.restore();
  }
  function xTicks(pen, X, y, width) {
    [-20, -10, 0, 10, 20].forEach(function (x) { text(pen, typed(x), X(x), y, "center"); });
    text(pen, "x/R\u0304", width, y, "right");
  }

  // the axis along y of what `rows` hold, down to `bottom`, with lines as far as `right`
  function linear(pen, rows, bottom, right) {
    const values = [0, 0.02].concat(...rows), top = Math.max(...values), least = Math.min(...values);
    const Y = function (value) { return 8 + (top - value) / (top - least) * (bottom - 8); };
    const step = [0.02, 0.05, 0.1, 0.2, 0.5, 1].find(function (s) { return (top - least) / s < 7; }) || 2;
    for (let tick = Math.ceil(least / step); tick * step <= top; tick++) {
      line(pen, [[LEFT, Y(tick * step)], [right, Y(tick * step)]], tick ? colour.grid : colour.soft, 1);
      text(pen, typed((tick * step).toFixed(2)), LEFT - 4, Y(tick * step), "right");
    }
    upright(pen, "force on a disk / F", bottom / 2);
    return Y;
  }

  // states on the scale of this one: the large responses of lost symmetry would flatten all others
  function fits(index) {
    return function (_, k) { return slab.symmetric[k] || !slab.symmetric[index]; };
  }
  function response(index) {
    const paper = sheet("floor", function (width) { return Math.max(150, 0.3 * width); }), pen = paper.pen;
    const X = across(paper.width).X, floor = slab.response[index];
    const rows = slab.response, values = rows[index];
    const Y = linear(pen, rows.filter(fits(index)), paper.height - 28, paper.width);
    line(pen, slab.x.map(function (x, k) { return [X(x), Y(rows[0][k])]; }), colour.soft, 3);
    line(pen, slab.x.map(function (x, k) { return [X(x), Y(values[k])]; }), colour.increased, 1.8);
    slab.x.forEach(function (x, k) {
      dot(pen, X(x), Y(floor[k]), 2.1, colour.increased, false);
      spots.floor.push([X(x), Y(floor[k]), "x = " + typed(x) + " R\u0304: " + mean(floor[k])]);
    });
    bold(pen, counted(slab.peaks[index]) + (slab.symmetric[index] ? "" : ", not symmetric"), LEFT + 6, 14, "left", colour.increased);
    xTicks(pen, X, paper.height - 10, paper.width);
  }

  // a plot with a logarithmic force axis, along x or along y
  function logarithm(low, high, from, to) {
    const scale = (to - from) / Math.log(high / low);
    return function (value) { return from + Math.log(value / low) * scale; };
  }

  function range(index) {
    const paper = sheet("range", function (width) { return Math.max(170, 0.62 * width); }), pen = paper.pen;
    const others = data.range;
    const motion = slab.motion ? slab.forces.indexOf(slab.motion) : slab.forces.length;
    const X = logarithm(0.1, Math.max(110, ...slab.forces), LEFT, paper.width - 40);
    const rows = others.map(function (one) { return one.centre; }).concat([slab.centre.filter(fits(index))]);
    const Y = linear(pen, rows, paper.height - 36, paper.width - 40);
    [0.1, 1, 10, 100].forEach(function (force) { text(pen, String(force), X(force), paper.height - 26, "center"); });
    text(pen, "F / mg", (LEFT + paper.width) / 2, paper.height - 9, "center");
    slab.paper.forEach(function (one) { line(pen, [[X(one.force), 8], [X(one.force), paper.height - 36]], colour.soft, 1, [2, 3]); });
    let low = -20;
    others.map(function (one) { return [Y(one.centre[one.centre.length - 1]), one]; })
      .sort(function (a, b) { return a[0] - b[0]; }).forEach(function (pair) {
        const one = pair[1];
        low = Math.max(pair[0], low + 11);
        line(pen, one.force.map(function (f, k) { return [X(f), Y(one.centre[k])]; }), colour.soft, 1);
        text(pen, "\u00b5 " + short(one.friction), X(one.force[one.force.length - 1]) + 4, low, "left");
      });
    const own = slab.forces.map(function (f, k) { return [X(f), Y(slab.centre[k]), "F = " + f + " mg: " + mean(slab.centre[k])]; });
    spots.range = own;
    line(pen, own.slice(0, motion), colour.increased, 2);
    own.filter(fits(index)).slice(motion).forEach(function (point) { dot(pen, point[0], point[1], 2.6, colour.increased, true); });
    const force = slab.forces[index];
    line(pen, [[X(force), 8], [X(force), paper.height - 36]], colour.ink, 1);
    dot(pen, X(force), Y(slab.centre[index]), 4.5, colour.ink);
  }

  const SHAPES = [0, 4, 3, 5];
  function polygon(pen, x, y, corners, radius, ink, filled, turn) {
    if (!corners) { dot(pen, x, y, radius, ink, !filled); return; }
    pen.beginPath();
    for (let k = 0; k < corners; k++) {
      const angle = turn + 2 * Math.PI * k / corners;
      pen.lineTo(x + 1.25 * radius * Math.sin(angle), y - 1.25 * radius * Math.cos(angle));
    }
    pen.closePath();
    pen.fillStyle = filled ? ink : colour.paper;
    pen.fill();
    pen.strokeStyle = ink;
    pen.lineWidth = 1.2;
    pen.stroke();
  }
  function phase(index) {
    const paper = sheet("phase", function (width) { return Math.max(190, 0.72 * width); }), pen = paper.pen;
    const X = function (friction) { return LEFT + 10 + friction * (paper.width - LEFT - 26); };
    const low = 0.08, height = logarithm(low, 600, paper.height - 38, 8);
    const Y = function (force) { return height(Math.min(600, Math.max(1.4 * low, force))); };  // bounds stay inside
    [0.1, 1, 10, 100].forEach(function (force) {
      line(pen, [[LEFT, Y(force)], [paper.width, Y(force)]], colour.grid, 1);
      text(pen, String(force), LEFT - 4, Y(force), "right");
    });
    [0, 0.2, 0.5, 1].forEach(function (friction) { text(pen, String(friction), X(friction), paper.height - 26, "center"); });
    text(pen, "\u00b5", paper.width - 8, paper.height - 9, "right");
    upright(pen, "F / mg", (paper.height - 38) / 2);
    text(pen, "\u03b4", LEFT, paper.height - 9, "left");
    data.crossovers.forEach(function (one, k) {
      const x = LEFT + 18 + 46 * k;
      polygon(pen, x, paper.height - 9, SHAPES[k % 4], 3.2, colour.soft, true, 0);
      text(pen, String(one.polydispersity), x + 7, paper.height - 9, "left");
    });
    data.crossovers.map(function (one, k) { return [one, SHAPES[k % 4]]; }).sort(function (a, b) {
      return !a[0].polydispersity - !b[0].polydispersity;
    }).forEach(function (pair) {
      const one = pair[0], mine = !one.polydispersity, ink = mine ? colour.increased : colour.soft;
      const points = one.friction.map(function (friction, k) { return [X(friction), Y(one.force[k])]; });
      line(pen, points.filter(function (_, k) { return !one.kind[k]; }), ink, mine ? 2 : 1, mine ? [] : [4, 3]);
      points.forEach(function (point, k) {
        spots.phase.push([...point, "\u03b4 = " + one.polydispersity + ", \u00b5 = " + one.friction[k] + ": two peaks " + begins(one, k)]);
        if (mine && one.low[k] !== one.high[k]) {
          line(pen, [[point[0], Y(one.low[k] || low)], [point[0], Y(one.high[k] || 600)]], ink, 1);
        }
        if (one.kind[k]) {
          polygon(pen, point[0], point[1], 3, 3.4, ink, false, one.kind[k] === 2 ? 0 : Math.PI);
        } else {
          polygon(pen, point[0], point[1], pair[1], 3.2, ink, true, 0);
        }
      });
    });
    const x = X(slab.friction), y = Y(slab.forces[index]);
    line(pen, [[LEFT, y], [paper.width, y]], colour.ink, 1);
    line(pen, [[x, 8], [x, paper.height - 38]], colour.ink, 1);
    dot(pen, x, y, 4.5, colour.ink);
  }
  const mean = function (value) { return typed(Number(value.toPrecision(3))); };
  const counted = function (count) { return count + (count === 1 ? " peak" : " peaks"); };
  function begins(curve, k) {
    return ["from ", "already below ", "not up to "][curve.kind[k]] + short(curve.force[k]) + " mg" + (curve.kind[k] ? "" : " on");
  }
  function shape(index) {
    const start = "The response (" + (slab.walls ? "rough" : "smooth") + " walls) ";
    const value = mean(slab.centre[index]) + " at x = 0; under " + slab.forces[0] + " mg it is " + mean(slab.centre[0]) + ".";
    return start + "has " + counted(slab.peaks[index]) + ", is " + (slab.symmetric[index] ? "" : "not ") +
      "symmetric, and is " + value;
  }

  function show() {
    if (!byId("network").clientWidth) { return; }  // a page that is not laid out is resized too
    readColours();
    value.hidden = true;
    const index = Number(slider.value), force = slab.forces[index], counts = contacts(index);
    response(index);
    range(index);
    phase(index);
    label.textContent = "F = " + force + " mg";
    slider.setAttribute("aria-valuetext", force + " mg");
    byId("link").href = "#mu=" + slab.friction + "&F=" + force;
    const reached = slab.motion && force >= slab.motion ? "dynamics from rest" : slab.motion ? "load path" : "";
    said.textContent = "F = " + force + " mg" + (reached ? " (" + reached + ")" : "") + ": " + counts.opened + (counts.opened === 1 ? " contact opened, " : " contacts opened, ") +
      counts.sliding + " at the Coulomb limit. Largest increase of a contact force: " + short(counts.most) +
      " F; largest decrease of one that stays closed: " + short(counts.least) + " F. " + shape(index);
    byId("network").setAttribute("aria-label", "Contacts of the slab, " + slab.about + ". " + said.textContent);
    byId("floor").setAttribute("aria-label", "Floor response against x under " + force + " mg, largest " +
      typed(Math.max.apply(null, slab.response[index]).toFixed(3)) + ". " + shape(index));
    byId("range").setAttribute("aria-label", "Response at x = 0 against the force, from " + mean(slab.centre[0]) +
      " at " + slab.forces[0] + " mg to " + mean(slab.centre[slab.centre.length - 1]) + " at " +
      slab.forces[slab.forces.length - 1] + " mg; the cursor is at " + force + " mg.");
    byId("phase").setAttribute("aria-label", "Force from which there are two peaks against friction; the cursor is at friction " +
      slab.friction + " and " + force + " mg.");
  }
  function moved() {
    wanted = slab.forces[Number(slider.value)];
    show();
  }

  let waiting = 0;
  window.addEventListener("resize", function () {
    window.cancelAnimationFrame(waiting);
    waiting = window.requestAnimationFrame(show);
  });
  slider.addEventListener("input", function () { stop(); moved(); });

  // the force grows by itself, by the same factor in each second, from the beginning if it is at the end
  const SECONDS_PER_DECADE = 4;
  const play = byId("play");
  let playing = 0;
  function stop() {
    window.clearInterval(playing);
    playing = 0;
    play.textContent = "Play";
  }
  play.addEventListener("click", function () {
    if (playing) { stop(); return; }
    if (slider.value === slider.max) { slider.value = 0; moved(); }
    play.textContent = "Stop";
    const begun = performance.now(), from = slab.forces[Number(slider.value)];
    playing = window.setInterval(function () {
      const force = from * Math.pow(10, (performance.now() - begun) / 1000 / SECONDS_PER_DECADE);
      const next = slab.forces.filter(function (f) { return f <= force; }).length - 1;
      if (next > Number(slider.value)) { slider.value = next; moved(); }
      if (slider.value === slider.max) { stop(); }
    }, 50);
  });

  // a link to a state: #mu=0.2&F=20
  function linked() {
    const asked = new URLSearchParams(window.location.hash.slice(1));
    if (!asked.has("F")) { return false; }
    document.querySelectorAll("input[name=friction]").forEach(function (input) {
      if (asked.has("mu") && Number(input.value) === Number(asked.get("mu"))) { input.checked = true; }
    });
    if (Number(asked.get("F")) > 0) { wanted = Number(asked.get("F")); }
    stop();
    select();
    return true;
  }
  window.addEventListener("hashchange", linked);
  document.querySelectorAll("#explorer input[type=radio]").forEach(function (input) {
    input.addEventListener("change", function () { stop(); select(); });
  });
  // print is light whatever the screen is
  ["(prefers-color-scheme: dark)", "print"].forEach(function (medium) {
    window.matchMedia(medium).addEventListener("change", show);
  });
  if (linked()) { byId("explorer").scrollIntoView({block: "nearest"}); } else { select(); }
  byId("explorer").dataset.ready = "";
})();
