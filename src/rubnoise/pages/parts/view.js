/* The page as a whole: its window, the chosen junction, the condition, and the place kept in its link. */
"use strict";
(() => {
  const { data } = view;
  const $ = (id) => document.getElementById(id);
  const shortest = Math.max(data.tick, 1e-9 * data.distance);
  /* A few lives at first, which can be distinguished. */
  const LIVES = 8;
  view.window = { from: data.start, to: Math.min(data.stop, data.start + LIVES * data.meanLife) };

  view.show = (from, to) => {
    let width = Math.min(Math.max(to - from, shortest), data.distance);
    const begin = Math.min(Math.max(from, 0), data.distance - width);
    view.window = { from: begin, to: begin + width };
    render();
  };
  view.zoom = (factor, around = (view.window.from + view.window.to) / 2) => {
    const { from, to } = view.window;
    view.show(around - factor * (around - from), around + factor * (to - around));
  };
  const move = (part) => {
    const { from, to } = view.window;
    view.show(from + part * (to - from), to + part * (to - from));
  };

  view.choose = (row) => {
    view.chosen = row;
    announce(row);
    render();
  };

  const figures = (life) => {
    const um = (value) => (value === null ? "not reached" : `${view.number(value)} µm`);
    const time = (value) => (value === null || Number.isNaN(value) ? "" : `, ${view.number(value)} s`);
    const share = (part) => `${Number((100 * part).toPrecision(3))} %`;
    const lines = [
      ["birth", um(life.birth) + time(life.birthTime)],
      ["mid-life", um(life.middle)],
      ["death", um(life.death) + time(life.deathTime)],
      ["life", um(life.length)],
      ["diameter", um(life.diameter)],
      ...(life.offset === null ? [] : [["lateral offset", um(life.offset)]]),
      [life.offset === null ? "area at full overlap" : "area at mid-life", `${view.number(life.maxArea)} µm²`],
      ...(life.strength === null ? [] : [["shear strength", `${view.number(life.strength)} MPa`]]),
      ["largest at", um(life.peak)],
      ["its area there", `${view.number(life.peakArea)} µm², ${share(life.areaShare)} of the contact`],
      ["real contact area there", `${view.number(life.realContactArea)} µm²`],
      ...(life.peakForce === null ? [] : [
        ["its force there", `${view.number(life.peakForce)} µN`],
        ["friction force there", `${view.number(life.frictionForce)} µN`],
      ]),
      ["alive beside it", view.grouped(life.others.length)],
    ];
    return lines.flatMap(([name, value]) => {
      const [term, text] = [document.createElement("dt"), document.createElement("dd")];
      [term.textContent, text.textContent] = [name, value];
      return [term, text];
    });
  };

  const MOST_NAMED = 60;
  let curve = null;
  const announce = (row) => {
    const life = view.life(row);
    $("life-title").textContent = `Junction ${life.junction}: ${view.stateNames(life.state).join(", ").replaceAll("_", " ")}`;
    $("life-figures").replaceChildren(...figures(life));
    $("others").replaceChildren(...life.others.slice(0, MOST_NAMED).map((junction) => {
      const open = document.createElement("button");
      open.type = "button";
      open.textContent = junction;
      open.setAttribute("aria-label", `Show junction ${junction}`);
      open.addEventListener("click", () => view.choose(view.rowOf(junction)));
      return open;
    }), life.others.length > MOST_NAMED ? ` and ${view.grouped(life.others.length - MOST_NAMED)} more` : "");
    const ages = Array.from({ length: 201 }, (_, i) => (life.length * i) / 200);
    const points = [ages.map((age) => life.birth + age), ages.map((age) => view.areaAtAge(row, age))];
    $("life").hidden = false;
    if (curve) curve.destroy();
    const place = $("life-curve");
    const axis = (label, size) => ({ label, labelSize: 20, size, font: "12px system-ui", stroke: () => view.ink("ink"), grid: { stroke: () => view.ink("grid") } });
    curve = new uPlot({
      width: place.clientWidth, height: 150, legend: { show: false }, scales: { x: { time: false } },
      axes: [axis("sliding distance (µm)", 36), axis("area (µm²)", 56)],
      series: [{}, { stroke: () => view.ink("exact"), width: 2, points: { show: false } }],
      cursor: { show: false },
    }, points, place);
    curve.root.querySelector("canvas").setAttribute("role", "img");
    curve.root.querySelector("canvas").setAttribute("aria-label", `area of junction ${life.junction} over its life`);
  };

  /** What stands under the pointer: place, live count and the values of the curves. */
  view.pointed = (chart, timed) => {
    const { left } = chart.cursor;
    if (left === null || left < 0 || left === undefined) return;
    const x = chart.posToVal(left, "x");
    const s = timed ? view.distanceAt(x) : x;
    const alive = view.aliveCount(s);
    const words = [`s = ${view.number(s)} µm`];
    if (data.speed) words.push(`t = ${view.number(timed ? x : data.twoWay ? view.timeAt(s) : s / data.speed)} s`);
    if (alive !== null) words.push(`${view.grouped(alive)} alive`);
    for (const [group, name, label, unit] of [
      ["trace", "real_contact_area", "area", "µm²"], ["trace", "friction_force", "force", "µN"],
      ["slider", "displacement", "x", "µm"], ["slider", "velocity", "x′", "µm/s"],
    ]) {
      const value = view.value(group, name, s);
      if (value !== null) words.push(`${label} = ${view.number(value)} ${unit}`);
    }
    $("readout").textContent = words.join("   ");
    const mark = $("alive");
    if (timed || alive === null) mark.hidden = true;
    else {
      mark.hidden = false;
      mark.textContent = `N = ${view.grouped(alive)}`;
      const box = $("lifelines").querySelector(".u-over");
      mark.style.left = `${box.offsetLeft + Math.min(left + 8, box.clientWidth - 80)}px`;
    }
  };

  const place = () => {
    const { from, to } = view.window;
    const kept = new URLSearchParams({ from, to });
    if (view.chosen !== null) kept.set("junction", view.lives.junction[view.chosen]);
    if ($("where").value) kept.set("where", $("where").value);
    history.replaceState(null, "", `#${kept}`);
  };

  const filter = () => {
    const text = $("where").value;
    const problem = $("where-problem");
    try {
      const chosen = text.trim() ? view.where(text, view.lives, data.states) : null;
      view.isKept = chosen;
      problem.textContent = "";
      $("where").removeAttribute("aria-invalid");
    } catch (refused) {
      if (!(refused instanceof view.ConditionRefused)) throw refused;
      problem.textContent = refused.message;
      $("where").setAttribute("aria-invalid", "true");
    }
    render();
  };

  let waiting = false;
  const render = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      view.redrawCharts();
      view.drawPhase();
      view.listLives();
      const { from, to } = view.window;
      $("where-shown").textContent = `${view.number(from)} to ${view.number(to)} µm of ${view.number(data.distance)} µm`;
      $("coarse").hidden = view.showsRows();
      place();
    });
  };

  const goTo = () => {
    const number = Number($("number").value);
    const row = view.rowOf(number);
    const problem = $("number-problem");
    problem.textContent = "";
    if (row !== null && $("number").value !== "") {
      view.choose(row);
      const { birth_distance: birth, death_distance: death } = view.lives;
      const { from, to } = view.window;
      if (birth[row] < from || death[row] > to) view.show(birth[row] - (death[row] - birth[row]), death[row] + (death[row] - birth[row]));
    } else if (Number.isInteger(number) && number >= 0 && number < data.junctionRows) {
      problem.textContent = `junction ${number} does not live in the stretch that this page holds`;
    } else problem.textContent = `the run has junctions 0 to ${data.junctionRows - 1}`;
  };

  const next = (by) => {
    const some = view.visibleLives().filter((row) => !view.isKept || view.isKept(row));
    if (!some.length) return;
    const now = some.indexOf(view.chosen);
    view.choose(some[now < 0 ? 0 : Math.min(Math.max(now + by, 0), some.length - 1)]);
  };

  const KEYS = {
    ArrowLeft: () => move(-0.25), ArrowRight: () => move(0.25), "+": () => view.zoom(0.5), "=": () => view.zoom(0.5),
    "-": () => view.zoom(2), 0: () => view.show(data.start, data.stop), n: () => next(1), p: () => next(-1),
  };
  $("charts").addEventListener("keydown", (event) => {
    if (event.target !== $("charts") || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!(event.key in KEYS)) return;
    event.preventDefault();
    KEYS[event.key]();
  });
  for (const [id, act] of Object.entries({
    "zoom-in": () => view.zoom(0.5), "zoom-out": () => view.zoom(2), back: () => move(-0.5), on: () => move(0.5),
    rows: () => view.show(data.start, data.stop), all: () => view.show(0, data.distance),
    previous: () => next(-1), following: () => next(1),
  })) $(id).addEventListener("click", act);
  $("filter").addEventListener("submit", (event) => { event.preventDefault(); filter(); });
  $("go").addEventListener("submit", (event) => { event.preventDefault(); goTo(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { view.recolourCharts(); view.drawPhase(); });
  addEventListener("resize", () => { view.resizeCharts(); view.drawPhase(); });

  const kept = new URLSearchParams(location.hash.slice(1));
  $("where").value = kept.get("where") ?? "";
  const ends = ["from", "to"].map((name) => Number(kept.get(name) ?? Number.NaN));
  if (ends.every(Number.isFinite) && ends[0] < ends[1]) {
    view.window = { from: Math.max(ends[0], 0), to: Math.min(ends[1], data.distance) };
  }
  const whole = data.start <= 0 && data.stop >= data.distance;
  $("holds").textContent = whole
    ? `This page holds all ${view.grouped(data.junctionRows)} junctions and every tick of the run.`
    : `This page holds every junction and every tick from ${view.number(data.start)} to ${view.number(data.stop)} µm. Elsewhere it shows the lowest and highest values of cells.`;
  if (data.planned !== null) {
    $("holds").textContent += ` The run is unfinished: it has reached ${view.number(data.distance)} of ${view.number(data.planned)} µm.`;
  }
  $("slider-part").hidden = !view.groups.slider;
  $("sticks-sign").hidden = !data.landmarks;
  view.makeCharts();
  view.makeLives();
  const chosen = kept.has("junction") ? view.rowOf(Number(kept.get("junction"))) : null;
  if (chosen !== null) view.choose(chosen);
  filter();
})();
