/* The page as a whole: its window, the chosen junction, the condition, and the place kept in its link. */
const { data } = view;
const { make } = rub;
const $ = (id) => document.getElementById(id);
/* A few lives at first, which can be distinguished. */
const LIVES = data.flights ? 60 : 8;
view.window = { from: data.start, to: Math.min(data.stop, data.start + LIVES * data.meanLife) };

view.choose = (row) => {
  view.chosen = row;
  announce(row);
  view.render();
};

/** Choose a row and zoom to its life. */
view.visit = (row) => {
  const { birth_distance: birth, death_distance: death } = view.lives;
  view.choose(row);
  view.show(1.5 * birth[row] - 0.5 * death[row], 1.5 * death[row] - 0.5 * birth[row]);
};

const figures = (life) => {
  /* Births in the page are right to some 1e-5 um, diameters to seven digits. */
  const six = (value) => view.number(Number(value.toPrecision(6)));
  const um = (value) => (value === null ? "not reached" : `${view.number(Number(value.toFixed(4)))} µm`);
  const time = (value) => (value === null || Number.isNaN(value) ? "" : `, ${six(value)} s`);
  const share = (part) => `${Number((100 * part).toPrecision(3))} %`;
  const { strength, offset, others } = life;
  const [birth, death] = [um(life.birth) + time(life.birthTime), um(life.death) + time(life.deathTime)];
  const strong = strength === null ? {} : { "shear strength": `${six(strength)} MPa` };
  const lines = data.flights ? {
    "contact made": birth, "contact lost": death, length: um(life.length), "largest overlap": um(life.maxOverlap),
    "diameter there": um(life.diameter), "area there": `${six(life.maxArea)} µm²`, ...strong,
    "in contact beside it half-way": view.grouped(others.length),
  } : {
    birth, "mid-life": um(life.middle), death, life: um(life.length), diameter: um(life.diameter),
    ...(offset === null ? {} : { "lateral offset": um(offset) }),
    [offset === null ? "area at full overlap" : "area at mid-life"]: `${six(life.maxArea)} µm²`, ...strong,
    "largest at": um(life.peak),
    "its area there": `${six(life.peakArea)} µm², ${share(life.areaShare)} of the contact`,
    "real contact area there": `${six(life.realContactArea)} µm²`,
    ...(strength === null ? {} : { "its force there": `${six(life.peakForce)} µN`, "friction force there": `${six(life.frictionForce)} µN` }),
    "alive beside it": view.grouped(others.length),
  };
  return Object.entries(lines).flatMap(([name, value]) => [make("dt", { text: name }), make("dd", { text: value })]);
};

let curve = null;
const announce = (row) => {
  const life = view.life(row);
  $("life-title").textContent = `${data.flights ? "Touch" : "Junction"} ${life.junction}: ${view.stateNames(life.state).join(", ").replaceAll("_", " ")}`;
  $("life-figures").replaceChildren(...figures(life));
  $("others").replaceChildren(...view.named(life.others.map(view.rowOf)));
  $("life").hidden = false;
  if (curve) curve.destroy();
  const place = $("life-curve");
  place.hidden = data.flights !== null;
  if (place.hidden) return;
  const ages = Array.from({ length: 201 }, (_, i) => (life.length * i) / 200);
  const points = [ages.map((age) => life.birth + age), ages.map((age) => view.areaAtAge(row, age))];
  curve = view.plot(place, points, {
    name: `area of junction ${life.junction} over its life`, height: 150,
    across: ["sliding distance (µm)", 36], up: ["area (µm²)", 56], series: [view.line("exact", 2)],
  });
};

/** A value with the digits that a pixel of so much can show. */
const seen = (value, pixel) => {
  if (!(pixel > 0)) return Number(value.toPrecision(7));
  return Number(value.toFixed(Math.min(Math.max(-Math.floor(Math.log10(pixel)), 0), 12)));
};

/** What stands under the pointer: place, live count and the values of the curves. */
view.pointed = (chart, timed) => {
  const { left } = chart.cursor;
  if (left === null || left < 0 || left === undefined) return;
  const { min, max } = chart.scales.x;
  const x = seen(chart.posToVal(left, "x"), (max - min) / chart.over.clientWidth);
  const s = timed ? view.distanceAt(x) : x;
  const alive = view.aliveCount(s);
  const words = [`s = ${timed ? view.number(s) : s} µm`];
  if (data.speed) words.push(`t = ${view.number(timed ? x : data.twoWay ? view.timeAt(s) : s / data.speed)} s`);
  if (alive !== null) words.push(`${view.grouped(alive)} alive`);
  for (const { group, name, symbol, unit } of view.CURVES) {
    const value = unit ? view.value(group, name, s) : null;
    if (value !== null) words.push(`${symbol} = ${seen(value, view.pixelOf(group, name))} ${unit}`);
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
  if (location.protocol !== "about:") history.replaceState(null, "", `#${kept}`);
  else if (!follows) parent.moved(window, from, to);
  follows = false;
};
/* Beside another run a page has no link of its own, and follows the window of the other. */
let follows = false;
window.redraw = () => view.redrawCharts();
window.follow = (from, to) => {
  follows = true;
  view.show(from, to, true);
};

const filter = () => {
  const text = $("where").value;
  const problem = $("where-problem");
  try {
    const chosen = text.trim() ? view.where(text, view.lives, data.states) : null;
    const kept = chosen && Uint8Array.from(view.lives.junction, (_, row) => chosen(row));
    view.isKept = kept && ((row) => kept[row] === 1);
    view.toFirstPage();
    problem.textContent = "";
    $("where").removeAttribute("aria-invalid");
  } catch (refused) {
    if (!(refused instanceof view.ConditionRefused)) throw refused;
    view.isKept = () => false;
    view.toFirstPage();
    problem.textContent = refused.message;
    $("where").setAttribute("aria-invalid", "true");
  }
  view.render();
};

let waiting = false;
view.render = () => {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    view.redrawCharts();
    view.drawStatistics();
    view.listLives();
    const { from, to } = view.window;
    $("where-shown").textContent = `${view.number(from)} to ${view.number(to)} µm of ${view.number(data.distance)} µm`;
    $("undo").disabled = !view.canUndo();
    $("coarse").hidden = view.showsRows() || (!view.groups.slider && view.summed(from, to) !== null);
    $("coarse").textContent = view.summed(from, to) === null
      ? "This window is longer than the ticks that this page holds: each point is the lowest or highest value of a cell."
      : "This page holds no ticks here: area and count are summed from the lives, and each point of the motion is the lowest or highest value of a cell.";
    place();
  });
};

const goTo = () => {
  const number = Number($("number").value);
  const row = view.rowOf(number);
  const problem = $("number-problem");
  problem.textContent = "";
  if (row !== null && $("number").value !== "") {
    view.visit(row);
  } else if (Number.isInteger(number) && number >= 0 && number < data.junctionRows) {
    problem.textContent = `${view.one} ${number} does not live in the stretch that this page holds`;
  } else problem.textContent = `the run has ${view.many} 0 to ${data.junctionRows - 1}`;
};

const next = (by) => {
  const some = view.visibleLives().filter((row) => !view.isKept || view.isKept(row));
  if (!some.length) return;
  const now = some.indexOf(view.chosen);
  const row = some[now < 0 ? 0 : Math.min(Math.max(now + by, 0), some.length - 1)];
  view.choose(row);
};

const KEYS = {
  ArrowLeft: () => view.move(-0.25), ArrowRight: () => view.move(0.25), u: () => view.undo(), "+": () => view.zoom(0.5), "=": () => view.zoom(0.5),
  "-": () => view.zoom(2), 0: () => view.show(data.start, data.stop), n: () => next(1), p: () => next(-1),
};
$("charts").addEventListener("keydown", (event) => {
  if (event.target !== $("charts") || event.ctrlKey || event.metaKey || event.altKey) return;
  if (!(event.key in KEYS)) return;
  event.preventDefault();
  KEYS[event.key]();
});
for (const [id, act] of Object.entries({
  "zoom-in": () => view.zoom(0.5), "zoom-out": () => view.zoom(2), back: () => view.move(-0.5), on: () => view.move(0.5), undo: () => view.undo(),
  rows: () => view.show(data.start, data.stop), all: () => view.show(0, data.distance),
  previous: () => next(-1), following: () => next(1),
})) $(id).addEventListener("click", act);
$("filter").addEventListener("submit", (event) => { event.preventDefault(); filter(); });
$("go").addEventListener("submit", (event) => { event.preventDefault(); goTo(); });
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { view.recolourCharts(); view.drawStatistics(); });
addEventListener("resize", () => { view.resizeCharts(); view.drawStatistics(); });

const kept = new URLSearchParams(location.hash.slice(1));
$("where").value = kept.get("where") ?? "";
const ends = ["from", "to"].map((name) => Number(kept.get(name) ?? Number.NaN));
if (ends.every(Number.isFinite) && ends[0] < ends[1]) {
  view.window = { from: Math.max(ends[0], 0), to: Math.min(ends[1], data.distance) };
}
const all = view.lives.junction.length === data.junctionRows;
const whole = data.start <= 0 && data.stop >= data.distance;
const stretch = `from ${view.number(data.start)} to ${view.number(data.stop)} µm`;
const lives = all ? `all ${view.grouped(data.junctionRows)} ${view.many}` : `every ${view.one}`;
$("holds").textContent = whole && all
  ? `This page holds ${lives} and every tick of the run.`
  : `This page holds ${lives}${all ? ", " : " "}and every tick ${stretch}. Elsewhere it shows the lowest and highest values of cells.`;
$("slider-part").hidden = !view.groups.slider;
$("sticks-sign").hidden = !data.landmarks;
$("flights-sign").hidden = !data.flights;
$("drive-sign").hidden = !data.twoWay;
if (!data.area) $("exact-sign").textContent = "exact mean";
view.makeCharts();
view.makeLives();
const chosen = kept.has("junction") ? view.rowOf(Number(kept.get("junction"))) : null;
if (chosen !== null) view.choose(chosen);
filter();
