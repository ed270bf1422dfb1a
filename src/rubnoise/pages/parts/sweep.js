/* The page of a sweep: its runs as points over what is swept, and one run beside them. */
const { data, ink, line } = view;
const { make } = rub;
const $ = (id) => document.getElementById(id);
const { columns } = data;
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#7a52a3", "#b3490b", "#4d4d4d", "#2e8b57"];
const LISTED = 200;
const words = (name) => name.replace(/^.*\./, "").replaceAll("_", " ");
const label = (name) => (["", "1"].includes(columns[name].units) ? words(name) : `${words(name)} (${columns[name].units})`);
const isNumeric = (name) => columns[name].values.every((value) => value === null || typeof value === "number");
const measured = data.figures.filter((name) => columns[name].values.some((value) => value !== null));
const PREFERRED = ["displacement_std", "real_contact_area_std"];
let chosen = null;
let chart = null;

const fill = (select, names, first) => {
  select.replaceChildren(...names.map((name) => new Option(label(name), name)));
  if (names.includes(first)) select.value = first;
};
const keys = data.keys.filter(isNumeric);
fill($("x"), [...keys, ...measured], keys[0] ?? measured[0]);
const preferred = PREFERRED.find((name) => measured.includes(name)) ?? measured[0];
fill($("y"), [...measured, ...keys], preferred);
fill($("colour"), [...data.keys, "replicate", ...measured], data.keys[1] ?? "replicate");
$("map").hidden = keys.length < 2;
/* A map over two keys has squares, in colours that rise evenly from the smallest to the largest. */
const isMap = () => keys.includes($("x").value) && keys.includes($("y").value);
const colourOf = (k, count) => (measured.includes($("colour").value) ? view.rising[Math.round((k * (view.rising.length - 1)) / Math.max(count - 1, 1))] : COLOURS[k]);

/* The mean over the replicates of a point, of what a map shows. */
const valuesOf = (name) => {
  const { values } = columns[name];
  if (!isMap() || !measured.includes(name)) return values;
  const sums = new Map();
  values.forEach((value, run) => {
    const [sum, count] = sums.get(data.points[run]) ?? [0, 0];
    if (value !== null) sums.set(data.points[run], [sum + value, count + 1]);
  });
  return data.points.map((point) => (sums.has(point) ? sums.get(point)[0] / sums.get(point)[1] : null));
};

/* Few values have a colour each; many are put into ten classes of equal width. */
const classes = (name) => {
  const values = valuesOf(name);
  const distinct = [...new Set(values.filter((value) => value !== null))].sort((a, b) => (typeof a === "number" ? a - b : String(a).localeCompare(b)));
  if (distinct.length <= COLOURS.length) {
    return { names: distinct.map((value) => (typeof value === "number" ? String(Number(value.toPrecision(4))) : String(value))), of: (run) => distinct.indexOf(values[run]) };
  }
  const [low, high] = [distinct[0], distinct[distinct.length - 1]];
  const width = (high - low) / COLOURS.length;
  return {
    names: COLOURS.map((_, k) => `${view.number(low + k * width)} to ${view.number(low + (k + 1) * width)}`),
    of: (run) => Math.min(COLOURS.length - 1, Math.floor((values[run] - low) / width)),
  };
};

const draw = () => {
  const [x, y] = [$("x").value, $("y").value];
  const [xs, ys] = [columns[x].values, columns[y].values];
  const [acrossLog, upLog] = [$("x-log").checked, $("y-log").checked];
  const usable = (value, isLog) => value !== null && (!isLog || value > 0);
  const runs = data.runs.map((_, run) => run).filter((run) => usable(xs[run], acrossLog) && usable(ys[run], upLog));
  runs.sort((a, b) => xs[a] - xs[b]);
  const { names, of } = classes($("colour").value);
  const exact = columns[`${y}_exact`]?.values;
  const series = names.map((_, k) => runs.map((run) => (of(run) === k ? ys[run] : null)));
  const values = [runs.map((run) => xs[run]), ...series];
  if (exact) values.push(runs.map((run) => (usable(exact[run], upLog) ? exact[run] : null)));
  if (chart) chart.destroy();
  const margin = (isLog) => (_, low, high) => {
    if (low === null || high === null) return [0, 1];
    if (isLog) return [low / 1.3, high * 1.3];
    const room = 0.06 * (high - low || Math.abs(high) || 1);
    return [low - room, high + room];
  };
  const marks = (colour) => ({ stroke: colour, paths: () => null, points: isMap() ? { show: true, size: 26, fill: colour, paths: squares } : { show: true, size: 8, fill: colour } });
  const place = $("plot");
  chart = view.plot(place, values, {
    name: `${words(y)} of ${runs.length} runs over ${words(x)}`, height: 420, across: [label(x), 48], up: [label(y), 80],
    axes: acrossLog || upLog ? view.numbered : {},
    scales: { x: { distr: acrossLog ? 3 : 1, range: margin(acrossLog) }, y: { distr: upLog ? 3 : 1, range: margin(upLog) } },
    series: [
      ...names.map((_, k) => marks(colourOf(k, names.length))),
      ...(exact ? [line("ink", 1, { paths: () => null, points: { show: true, size: 14, width: 2, paths: dashes } })] : []),
    ],
    cursor: { drag: { x: false, y: false }, points: { show: false } },
    hooks: { draw: [(one) => ring(one, xs, ys)] },
  });
  chart.over.addEventListener("click", (event) => {
    const box = chart.over.getBoundingClientRect();
    const away = (run) => Math.hypot(chart.valToPos(xs[run], "x") - (event.clientX - box.left), chart.valToPos(ys[run], "y") - (event.clientY - box.top));
    const near = runs.reduce((best, run) => (best === null || away(run) < away(best) ? run : best), null);
    if (near !== null && away(near) < 16) choose(near);
  });
  $("legend").replaceChildren(...names.map((name, k) => sign("dot", `${words($("colour").value)} ${name}`, colourOf(k, names.length))), ...(exact ? [sign("dash", "exact")] : []));
  list();
};

/* A mark for each value of a series. */
const marked = (outline, isFilled) => (one, seriesIndex, first, last) => {
  const path = new Path2D();
  for (let i = first; i <= last; i += 1) {
    const value = one.data[seriesIndex][i];
    if (value !== null) outline(path, one.valToPos(one.data[0][i], "x", true), one.valToPos(value, "y", true));
  }
  return { stroke: path, fill: isFilled ? path : null, flags: isFilled ? 3 : 2 };
};
/* Exact values are dashes, so that the points show through. */
const dashes = marked((path, x, y) => {
  path.moveTo(x - 9 * devicePixelRatio, y);
  path.lineTo(x + 9 * devicePixelRatio, y);
}, false);
const squares = marked((path, x, y) => {
  const half = 13 * devicePixelRatio;
  path.rect(x - half, y - half, 2 * half, 2 * half);
}, true);

/* Spectra of points over each other, each in a colour. */
const drawSpectra = () => {
  const runs = Object.keys(data.spectra);
  $("spectra-part").hidden = !runs.length;
  if (!runs.length) return;
  const curves = runs.map((run) => data.spectra[run]);
  $("spectra").replaceChildren();
  view.plot($("spectra"), uPlot.join(curves), {
    name: `spectra of the real contact area of ${runs.length} points`, height: 320, axes: view.numbered,
    across: ["wavenumber (rad/µm)", 48], up: ["S (µm⁴ per rad/µm)", 80], scales: { x: { distr: 3 }, y: { distr: 3 } },
    series: runs.map((_, k) => ({ stroke: COLOURS[k], width: 1.4, spanGaps: true, points: { show: false } })),
  });
  $("spectra-legend").replaceChildren(...runs.map((id, k) => {
    const run = data.runs.indexOf(id);
    return sign("dot", data.keys.map((key) => `${words(key)} ${shown(columns[key].values[run])}`).join(", "), COLOURS[k]);
  }));
};

const ring = (one, xs, ys) => {
  if (chosen === null || xs[chosen] === null || ys[chosen] === null) return;
  one.ctx.strokeStyle = ink("ink");
  one.ctx.lineWidth = 2 * devicePixelRatio;
  one.ctx.beginPath();
  one.ctx.arc(one.valToPos(xs[chosen], "x", true), one.valToPos(ys[chosen], "y", true), 9 * devicePixelRatio, 0, 2 * Math.PI);
  one.ctx.stroke();
};

const sign = (kind, text, colour) =>
  make("span", {}, make("i", { class: kind, style: colour && `background: ${colour}` }), ` ${text}`);

const shown = (value) => (value === null ? "–" : typeof value === "number" ? (Number.isInteger(value) ? String(value) : view.number(value)) : value);

const list = () => {
  const names = [...new Set([...data.keys, "replicate", $("x").value, $("y").value])];
  const heading = ["run", ...names.map(label)].map((text) => make("th", { text }));
  document.querySelector("#runs thead").replaceChildren(make("tr", {}, ...heading));
  const lines = data.runs.slice(0, LISTED).map((id, run) => {
    const open = make("button", { type: "button", text: id, "aria-label": `Show run ${id}`, onclick: () => choose(run) });
    const cells = names.map((name) => make("td", { text: shown(columns[name].values[run]) }));
    return make("tr", { class: run === chosen && "chosen" }, make("th", {}, open), ...cells);
  });
  document.querySelector("#runs tbody").replaceChildren(...lines);
  $("listed").textContent = data.runs.length > LISTED ? `The first ${LISTED} of ${view.grouped(data.runs.length)} runs.` : "";
};

const small = (place, points, [across, up]) => {
  const box = make("div");
  place.append(box);
  const name = `${up} at the beginning of the run`;
  view.plot(box, points, { name, height: 150, across: [across, 44], up: [up, 70], series: [line("curve", 1.2)] });
};

const term = (name, text) => [make("dt", { text: name }), make("dd", { text })];

const choose = (run) => {
  chosen = run;
  $("run-title").textContent = `Run ${data.runs[run]}`;
  const place = $("beginning");
  place.replaceChildren();
  const beginning = data.beginnings[data.runs[run]];
  if (beginning?.trace) small(place, beginning.trace.points, ["sliding distance (µm)", "area (µm²)"]);
  if (beginning?.slider) small(place, beginning.slider.points, ["time (s)", "x (µm)"]);
  if (!beginning || beginning.refused) {
    place.append(make("p", { text: beginning ? beginning.refused : "This page does not hold the beginning of this run." }));
  }
  $("figures").replaceChildren(...[...data.keys, "replicate", "seed", ...measured].flatMap((name) => {
    const value = columns[name]?.values[run] ?? null;
    const exact = columns[`${name}_exact`]?.values[run] ?? null;
    return value === null ? [] : term(label(name), shown(value) + (exact === null ? "" : `, exact ${shown(exact)}`));
  }));
  const code = make("code", { text: `rubnoise page ${data.name}/runs/${data.runs[run]}.h5` });
  $("command").replaceChildren(...(beginning?.refused ? [] : ["The whole run: ", code]));
  keep();
  chart.redraw(false);
  list();
};

const keep = () => {
  const kept = new URLSearchParams({ x: $("x").value, y: $("y").value, colour: $("colour").value });
  for (const id of ["x-log", "y-log"]) if ($(id).checked) kept.set(id, "1");
  if (chosen !== null) kept.set("run", data.runs[chosen]);
  history.replaceState(null, "", `#${kept}`);
};

const kept = new URLSearchParams(location.hash.slice(1));
for (const id of ["x", "y", "colour"]) {
  if ([...$(id).options].some((option) => option.value === kept.get(id))) $(id).value = kept.get(id);
}
for (const id of ["x-log", "y-log"]) $(id).checked = kept.has(id);
$("holds").textContent = Object.entries(data.states).filter(([, count]) => count).map(([state, count]) => `${view.grouped(count)} ${state}`).join(", ");
$("map").addEventListener("click", () => {
  [$("x").value, $("y").value, $("colour").value] = [keys[0], keys[1], preferred];
  draw();
  keep();
});
$("axes").addEventListener("change", () => { draw(); keep(); });
addEventListener("resize", () => chart.setSize({ width: $("plot").clientWidth, height: 420 }));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { draw(); drawSpectra(); });
if (data.failures.length) {
  $("failures").hidden = false;
  const lines = data.failures.map(({ run, reason }) => make("li", { text: `${run}: ${reason}` }));
  $("failures").querySelector("ul").replaceChildren(...lines);
}
draw();
drawSpectra();
const run = data.runs.indexOf(kept.get("run"));
if (run >= 0) choose(run);
