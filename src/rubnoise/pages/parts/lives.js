/* Life-lines: a bar for each junction from birth to death, in lanes in which no two overlap. */
const { data } = view;
const rows = view.lives;
view.chosen = null;
view.mark = null;
view.isKept = null;

/* What a free slider makes at a summit, and may lose and make again, is a touch. */
[view.one, view.many] = data.flights ? ["touch", "touches"] : ["junction", "junctions"];
if (data.flights) for (const each of document.querySelectorAll("[data-touch]")) each.textContent = each.dataset.touch;

const COLOURS = view.rising;
const MOST_MARKED = 1500;
const MOST_DRAWN = 20000;

const { birth_distance: birth, death_distance: death, diameter } = rows;
const lanes = new Uint32Array(birth.length);
const ends = [];
for (let row = 0; row < birth.length; row += 1) lanes[row] = rub.laneOf(ends, birth[row], death[row]);
const laneCount = Math.max(1, ends.length);
let [least, most] = [Infinity, -Infinity];
for (const d of diameter) [least, most] = [Math.min(least, d), Math.max(most, d)];
const shade = (row) => Math.min(COLOURS.length - 1, Math.floor((COLOURS.length * (diameter[row] - least)) / (most - least || 1)));

const visible = view.livesBetween;
view.visibleLives = () => visible(view.window.from, view.window.to);

const strokes = (chart, some, colour, width) => {
  const { ctx, bbox } = chart;
  ctx.strokeStyle = colour;
  ctx.lineWidth = width;
  ctx.beginPath();
  for (const row of some) {
    const y = chart.valToPos(lanes[row] + 0.5, "y", true);
    const left = Math.max(chart.valToPos(birth[row], "x", true), bbox.left);
    const right = Math.min(chart.valToPos(death[row], "x", true), bbox.left + bbox.width);
    ctx.moveTo(left, y);
    ctx.lineTo(Math.max(right, left + 0.5), y);
  }
  ctx.stroke();
};

const marks = (chart, some, size) => {
  const { ctx, bbox } = chart;
  const inside = (x) => x >= bbox.left - 1 && x <= bbox.left + bbox.width + 1;
  ctx.lineWidth = 1.4 * devicePixelRatio;
  ctx.strokeStyle = view.ink("ink");
  ctx.fillStyle = view.ink("ground");
  for (const row of some) {
    const y = chart.valToPos(lanes[row] + 0.5, "y", true);
    const [left, right] = [birth[row], death[row]].map((s) => chart.valToPos(s, "x", true));
    if (inside(left)) {
      ctx.beginPath();
      ctx.arc(left, y, size, 0, 2 * Math.PI);
      ctx.fill();
      ctx.stroke();
    }
    if (inside(right)) {
      ctx.beginPath();
      ctx.moveTo(right - size, y - size);
      ctx.lineTo(right + size, y + size);
      ctx.moveTo(right - size, y + size);
      ctx.lineTo(right + size, y - size);
      ctx.stroke();
    }
  }
};

const draw = (chart) => view.clipped(chart, (ctx) => {
  const { bbox } = chart;
  const { from, to } = view.window;
  const all = visible(from, to);
  const every = Math.ceil(all.length / MOST_DRAWN);
  const some = every > 1 ? all.filter((_, i) => i % every === 0) : all;
  const lane = bbox.height / laneCount;
  const width = Math.max(Math.min(0.6 * lane, 12 * devicePixelRatio), 1);
  const { start, stop } = data.junctions;
  if (to < start || from > stop) {
    ctx.fillStyle = view.ink("ink");
    ctx.font = `${14 * devicePixelRatio}px system-ui`;
    ctx.textAlign = "center";
    ctx.fillText("The lives of this stretch are not in this page.", bbox.left + bbox.width / 2, bbox.top + bbox.height / 2);
  }
  const kept = view.isKept;
  if (kept) strokes(chart, some.filter((row) => !kept(row)), view.ink("grid"), width);
  const drawn = kept ? some.filter(kept) : some;
  COLOURS.forEach((colour, k) => strokes(chart, drawn.filter((row) => shade(row) === k), colour, width));
  if (view.chosen !== null) strokes(chart, [view.chosen], view.ink("exact"), Math.max(width, 3 * devicePixelRatio));
  if (some.length <= MOST_MARKED && lane >= 4 * devicePixelRatio) {
    marks(chart, drawn, Math.min(0.3 * lane, 4 * devicePixelRatio));
  } else if (view.chosen !== null) marks(chart, [view.chosen], 4 * devicePixelRatio);
  if (every > 1) {
    ctx.fillStyle = view.ink("ink");
    ctx.font = `${12 * devicePixelRatio}px system-ui`;
    ctx.textAlign = "left";
    ctx.fillText(`1 of ${every} bars is drawn`, bbox.left + 6, bbox.top + 14 * devicePixelRatio);
  }
  view.drawMark(chart);
  for (const [edge, isIn] of [[start, from < start], [stop, to > stop]]) {
    if (!isIn) continue;
    ctx.setLineDash([6, 6]);
    view.upright(chart, edge);
    ctx.setLineDash([]);
  }
});

const hit = (chart, event) => {
  const box = chart.over.getBoundingClientRect();
  const s = chart.posToVal(event.clientX - box.left, "x");
  const lane = chart.posToVal(event.clientY - box.top, "y") - 0.5;
  const slack = (3 * (view.window.to - view.window.from)) / box.width;
  let [best, nearest] = [null, Math.max(1, (6 * laneCount) / box.height)];
  for (const row of visible(s - slack, s + slack)) {
    const away = Math.abs(lanes[row] - lane);
    if (away < nearest) [best, nearest] = [row, away];
  }
  return best;
};

const place = document.getElementById("lifelines");
view.makeLives = () => {
  const ends = () => [[view.window.from, view.window.to], [0, laneCount]];
  const chart = view.newChart(place, {
    name: `life-lines of ${view.many}`, timed: false, across: ["sliding distance (µm)", 38], up: ["life-lines", 86], height: 300,
    range: () => [0, laneCount], data: ends(), series: [{ stroke: "transparent", points: { show: false } }], hooks: { draw: [draw] },
  });
  chart.over.addEventListener("click", (event) => {
    const row = hit(chart, event);
    if (row !== null) view.choose(row);
  });
  chart.over.addEventListener("mousemove", (event) => {
    chart.over.style.cursor = hit(chart, event) === null ? "crosshair" : "pointer";
  });
  view.addChart({ chart, place, redraw: () => chart.setData(ends()) });
  const steps = COLOURS.map((colour) => rub.make("i", { style: `background: ${colour}` }));
  document.getElementById("shades").append(...steps);
  document.getElementById("least").textContent = Number.isFinite(least) ? `${view.number(least)} µm` : "";
  document.getElementById("most").textContent = Number.isFinite(most) ? `${view.number(most)} µm` : "";
};

/** How many bars a cursor at a distance cuts; null outside of the stretch whose lives the page holds. */
view.aliveCount = (s) => (s < data.junctions.start || s > data.junctions.stop ? null : view.aliveAt(s).length);

view.rowOf = (junction) => {
  const row = rub.firstAtLeast(rows.junction, junction);
  return rows.junction[row] === junction ? row : null;
};
