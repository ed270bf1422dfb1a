/* Curves over sliding distance or time: every row inside the stretch of the page, extremes of cells elsewhere. */
const { data, ink, shaded } = view;
const MOST_POINTS = 3000;
const groups = Object.fromEntries(
  Object.entries(data.groups).map(([name, group]) => [name, { first: group.first, ...view.columns(group.columns) }]),
);
const unpacked = (columns) => columns && Object.fromEntries(Object.entries(columns).map(([name, column]) => [name, view.unpacked(column)]));
const levels = Object.fromEntries(
  Object.entries(data.levels).map(([name, { step, rows, ...curves }]) => [
    name,
    { step, rows, ...Object.fromEntries(Object.entries(curves).map(([curve, ends]) => [curve, unpacked(ends)])) },
  ]),
);
view.groups = groups;

const rising = (values) => {
  const found = Float64Array.from(values);
  for (let i = 1; i < found.length; i += 1) found[i] = Math.max(found[i], found[i - 1]);
  return found;
};

/** Time and distance of a slider that pushes back, which has a clock of its own. */
const clock = data.twoWay && groups.slider.time.length > 1
  ? {
      step: groups.slider.time[1] - groups.slider.time[0],
      reached: rising(groups.slider.distance),
      reachedInAll: rising(levels.slider.distance.high),
    }
  : null;

const isTimed = (group) => clock !== null && group === "slider";

/** The time in s at which the slider first reaches a distance; the distance itself where both are the same axis. */
view.timeAt = (s) => {
  if (clock === null) return s;
  if (s >= data.start && s <= data.stop) {
    const { time } = groups.slider;
    return time[Math.min(rub.firstAtLeast(clock.reached, s), time.length - 1)];
  }
  return rub.firstAtLeast(clock.reachedInAll, s) * levels.slider.step * clock.step;
};

/** The distance that the slider has reached at a time. */
view.distanceAt = (t) => {
  if (clock === null) return t;
  const row = Math.round(t / clock.step) - groups.slider.first;
  if (row >= 0 && row < clock.reached.length) return clock.reached[row];
  const cell = Math.floor(t / clock.step / levels.slider.step);
  return clock.reachedInAll[Math.min(Math.max(cell, 0), clock.reachedInAll.length - 1)];
};

const isWhole = (from, to) => from >= data.start - 1e-9 * data.distance && to <= data.stop + 1e-9 * data.distance;
view.showsRows = () => isWhole(view.window.from, view.window.to);

const thinned = (place, values, first, last) => {
  const count = last - first;
  if (count <= MOST_POINTS) {
    const rows = Array.from({ length: Math.max(count, 0) }, (_, i) => first + i);
    return [rows.map(place), rows.map((i) => values[i])];
  }
  const step = Math.ceil((2 * count) / MOST_POINTS);
  const [xs, ys] = [[], []];
  for (let begin = first; begin < last; begin += step) {
    const end = Math.min(begin + step, last);
    let [low, high] = [begin, begin];
    for (let i = begin; i < end; i += 1) {
      if (values[i] < values[low]) low = i;
      if (values[i] > values[high]) high = i;
    }
    for (const i of low < high ? [low, high] : low > high ? [high, low] : [low]) {
      xs.push(place(i));
      ys.push(values[i]);
    }
  }
  return [xs, ys];
};

/** What is from one tick of a group to the next: um, or s of a slider with a clock of its own. */
const paceOf = (group) => (isTimed(group) ? clock.step : data.tick);

/** Two sliding distances in ticks of a group. */
const ticksAt = (group, ...places) => places.map((s) => (isTimed(group) ? view.timeAt(s) : s) / paceOf(group));

/** The rows of a group between two distances and the next one on each side: the first, and the first that is not. */
const rowsOf = (group, from, to) => {
  const [begin, end] = ticksAt(group, from, to);
  const { first, units } = groups[group];
  const { length } = groups[group][Object.keys(units)[0]];
  return [Math.floor(begin), Math.ceil(end) + 1].map((row) => Math.min(Math.max(row - first, 0), length));
};

/** The sums over lives at every tick, of a curve that has such. */
const summed = (group, name, from, to) => {
  const sums = group === "trace" ? view.summed(from, to) : null;
  return sums?.[name] ? { first: sums.first, values: sums[name] } : null;
};

/** Places and values of a curve between two sliding distances in um. */
const curve = (group, name, from, to) => {
  const pace = paceOf(group);
  const { first, [name]: values } = groups[group];
  if (isWhole(from, to)) return thinned((i) => (first + i) * pace, values, ...rowsOf(group, from, to));
  const sums = summed(group, name, from, to);
  if (sums) return thinned((i) => (sums.first + i) * pace, sums.values, 0, sums.values.length);
  const { step, [name]: cells } = levels[group];
  const [begin, end] = ticksAt(group, from, to);
  const low = Math.max(Math.floor(begin / step), 0);
  const high = Math.min(Math.ceil(end / step) + 1, cells.low.length);
  const [xs, ys] = [[], []];
  for (let cell = low; cell < high; cell += 1) {
    const place = (cell + 0.5) * step * pace;
    xs.push(place, place);
    ys.push(cells.low[cell], cells.high[cell]);
  }
  return [xs, ys];
};
const [flights, turns] = [unpacked(data.flights), unpacked(data.landmarks?.reversals)];
const sticks = data.landmarks && unpacked({ begin: data.landmarks.begin, end: data.landmarks.end });

/** Shade what goes from begins to ends: sticks, flights. */
const shadeAll = (spans) => (chart) => {
  const { min, max } = chart.scales.x;
  const { begin, end } = spans ?? { begin: [], end: [] };
  for (let i = rub.firstAtLeast(end, min); i < begin.length && begin[i] <= max; i += 1) shaded(chart, begin[i], end[i], ink("stick"));
};

const MOST_MARKS = 2000;
/** Mark places on a curve, of which none has a mark where the curve is not known: turns, impacts. */
const markAll = (places, valueOf, outline) => (chart) => {
  const { min, max } = chart.scales.x;
  const [first, last] = places ? [min, max].map((end) => rub.firstAtLeast(places, end)) : [0, 0];
  if (last - first > MOST_MARKS) return;
  const { ctx } = chart;
  ctx.strokeStyle = ink("exact");
  ctx.lineWidth = 1.5 * devicePixelRatio;
  for (let i = first; i < last; i += 1) {
    const value = valueOf(i);
    if (value === null) continue;
    ctx.beginPath();
    outline(ctx, chart.valToPos(places[i], "x", true), chart.valToPos(value, "y", true), 3 * devicePixelRatio);
    ctx.stroke();
  }
};
const square = (ctx, x, y, size) => ctx.rect(x - size, y - size, 2 * size, 2 * size);
const circle = (ctx, x, y, size) => ctx.arc(x, y, size, 0, 2 * Math.PI);
const MARKS = {
  displacement: markAll(turns?.time, (i) => turns.displacement[i], square),
  normal_velocity: markAll(flights?.place, (i) => view.value("load", "velocity", flights.place[i]), circle),
};
const drawLife = (chart) => {
  if (view.chosen === null) return;
  shaded(chart, view.lives.birth_distance[view.chosen], view.lives.death_distance[view.chosen], ink("life"));
};
view.drawMark = (chart) => {
  if (view.mark !== null) view.upright(chart, view.mark);
};
const drawBand = (exact) => (chart) => view.clipped(chart, (ctx) => {
  const { left, width } = chart.bbox;
  const [high, low] = [1, -1].map((n) => chart.valToPos(exact.mean + n * (exact.std ?? 0), "y", true));
  ctx.fillStyle = ink("band");
  ctx.fillRect(left, high, width, low - high);
  view.level(chart, exact.mean, "exact");
});

/** Every curve: its name, of which two may be columns of one name, and its symbol and unit. */
const CURVES = [
  { called: "real_contact_area", symbol: "area", unit: "µm²", exact: data.area, fromZero: true },
  { called: "junction_count", symbol: "live junctions", exact: data.count && { ...data.count, std: Math.sqrt(data.count.mean) }, fromZero: true },
  { called: "friction_force", symbol: "force", unit: "µN", fromZero: true },
  { called: "displacement", group: "slider", symbol: "x", unit: "µm" },
  { called: "velocity", group: "slider", symbol: "x′", unit: "µm/s" },
  { called: "load", group: "load", symbol: "load", unit: "µN", exact: data.weight && { mean: data.weight }, fromZero: true },
  { called: "separation", group: "load", symbol: "z", unit: "µm" },
  { called: "normal_velocity", group: "load", name: "velocity", symbol: "z′", unit: "µm/s" },
];
for (const each of CURVES) Object.assign(each, { group: each.group ?? "trace", name: each.name ?? each.called });

const made = [];

/** Dragging over any chart zooms to what was dragged over. */
const zoomTo = (chart, timed) => {
  const { left, width } = chart.select;
  if (width > 3) {
    const ends = [left, left + width].map((x) => chart.posToVal(x, "x"));
    view.show(...(timed ? ends.map(view.distanceAt) : ends));
  }
  chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
};

view.newChart = (place, { name, timed, range, hooks = {}, data: values, ...more }) => {
  const ends = () => [view.window.from, view.window.to];
  const chart = view.plot(place, values, {
    name: `${name} over ${timed ? "time" : "sliding distance"}`,
    scales: { x: { range: () => (timed ? ends().map(view.timeAt) : ends()) }, y: { range } },
    series: [view.line("curve", 1.4)],
    cursor: {
      y: false, drag: { x: true, y: false, setScale: false }, sync: { key: timed ? "time" : "distance", setSeries: false },
    },
    hooks: { setSelect: [(one) => zoomTo(one, timed)], setCursor: [(one) => view.pointed(one, timed)], ...hooks },
    ...more,
  });
  chart.over.addEventListener("dblclick", () => view.show(data.start, data.stop));
  view.zoomsByWheel(chart, (value) => (timed ? view.distanceAt(value) : value));
  return chart;
};

/** The ends of an axis about its values; beside another run they are those of both. */
const around = (fromZero, name) => (_, low, high) => {
  const [bottom, top] = [fromZero ? Math.min(0, low ?? 0) : (low ?? -1), high ?? 1];
  const margin = 0.06 * (top - bottom || 1);
  const range = [fromZero && bottom === 0 ? 0 : bottom - margin, top + margin];
  return location.protocol === "about:" ? parent.shared(window, name, range) : range;
};

/** Make a chart for each curve that the run has. */
view.makeCharts = () => {
  for (const { called, group, name, symbol, unit, exact, fromZero } of CURVES) {
    if (!groups[group] || !(name in groups[group].units)) continue;
    const place = rub.make("div", { class: "chart", "data-curve": called });
    document.getElementById(group === "slider" ? "motion" : "contact").append(place);
    const timed = isTimed(group);
    const before = [...(exact ? [drawBand(exact)] : []), ...(timed ? [shadeAll(sticks)] : [shadeAll(flights), drawLife, view.drawMark])];
    const chart = view.newChart(place, {
      name: called.replaceAll("_", " "), timed, across: [timed ? "time (s)" : "sliding distance (µm)", 38], up: [unit ? `${symbol} (${unit})` : symbol, 86], height: 170, range: around(fromZero, called),
      data: curve(group, name, view.window.from, view.window.to),
      hooks: { drawClear: before, draw: [MARKS[called]].filter(Boolean) },
    });
    made.push({ chart, redraw: () => chart.setData(curve(group, name, view.window.from, view.window.to)), place });
  }
  const place = document.getElementById("overview");
  const overview = view.plot(place, curve("trace", "real_contact_area", 0, data.distance), {
    name: "", height: 96, across: [undefined, 26], up: ["area", 86], series: [view.line("curve", 1)],
    scales: { x: { range: () => [0, data.distance] }, y: { range: around(true, "overview") } },
    hooks: {
      drawClear: [(chart) => {
        // A shade over all of it would say nothing, and look like a band of theory.
        if (data.start > 0 || data.stop < data.distance) shaded(chart, data.start, data.stop, ink("band"));
        shaded(chart, view.window.from, view.window.to, ink("life"));
      }],
    },
  });
  view.movesWindow(overview);
  view.zoomsByWheel(overview, (value) => value);
  overview.root.querySelector("canvas").setAttribute("aria-hidden", "true");
  made.push({ chart: overview, redraw: () => overview.redraw(false), place });
};

view.addChart = (one) => made.push(one);
view.redrawCharts = () => made.forEach(({ redraw }) => redraw());
view.recolourCharts = () => made.forEach(({ chart }) => chart.redraw(false, true));
view.resizeCharts = () => made.forEach(({ chart, place }) => chart.setSize({ width: place.clientWidth, height: chart.height }));
/** The value of a curve at a distance: of the nearest tick, or where the page holds none of the sum over lives. */
view.value = (group, name, s) => {
  const found = groups[group];
  if (!found || !(name in found.units)) return null;
  const row = Math.round(ticksAt(group, s)[0]) - found.first;
  if (row >= 0 && row < found[name].length) return found[name][row];
  return group === "trace" ? view.sumAt(name, s) : null;
};

/** Every tick of a curve in the window in sight; null where the page does not know them. */
view.ticksOf = (group, name) => {
  const { from, to } = view.window;
  if (!isWhole(from, to)) return summed(group, name, from, to)?.values ?? null;
  const { first, [name]: values } = groups[group];
  const [begin, end] = ticksAt(group, from, to);
  return values.subarray(Math.max(Math.ceil(begin - 1e-6) - first, 0), Math.floor(end + 1e-6) - first + 1);
};

/** How much a pixel is of a curve: its digits beyond that cannot be seen. */
view.pixelOf = (group, name) => {
  const { called } = CURVES.find((each) => each.group === group && each.name === name);
  const one = made.find(({ place }) => place.dataset.curve === called);
  if (!one) return null;
  const { min, max } = one.chart.scales.y;
  return (max - min) / one.chart.over.clientHeight;
};
Object.assign(view, { CURVES, curve, rowsOf, isTimed });
