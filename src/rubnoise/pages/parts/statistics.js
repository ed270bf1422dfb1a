/* Spectrum and histogram of the window in sight or of the whole run, beside what theory expects. */
const { data } = view;
const $ = (id) => document.getElementById(id);
const FEWEST = 8;
const BARS = 40;
const SQUARES = { area: "µm⁴ per rad/µm", velocity: "µm²/s² per rad/s", normal: "µm²/s² per rad/s", load: "µN² per rad/s" };
const CALLED = { area: "real_contact_area", velocity: "velocity", normal: "normal_velocity", load: "load" };
const QUANTITIES = Object.fromEntries(Object.entries(CALLED).map(([quantity, called]) => [quantity, view.CURVES.find((each) => each.called === called)]));
const { density: law, phase: _, ...packed } = data.statistics;
const density = law && view.unpacked(law);
const whole = Object.fromEntries(Object.entries(packed).map(([name, found]) => [name, found && {
  ...found, density: view.unpacked(found.density), counts: view.unpacked(found.counts), expected: found.expected && view.unpacked(found.expected),
}]));
view.isWhole = () => $("part").value === "whole";
const words = () => (view.isWhole() ? "the whole run" : "this window");
for (const select of ["heard", "counted"])
  for (const option of $(select).options) option.hidden = option.disabled = whole[option.value] === null;

const made = {};
const draw = (id, values, { logarithmic, ...more }) => {
  made[id]?.destroy();
  const scale = logarithmic ? { distr: 3 } : {};
  made[id] = view.plot($(id), values, { height: 230, axes: view.numbered, scales: { x: scale, y: scale }, ...more });
};
const { line } = view;

const spectrum = () => {
  const heard = $("heard").value;
  const { group, name } = QUANTITIES[heard];
  const across = group === "trace" ? "wavenumber (rad/µm)" : "angular frequency (rad/s)";
  const { step, ticks, expected } = whole[heard];
  const values = view.isWhole() ? null : view.ticksOf(group, name);
  const { density: seen, segments } = view.isWhole() ? whole[heard] : values && values.length >= ((FEWEST + 1) * ticks) / 2 ? view.welch(values, step, ticks) : { segments: 0 };
  $("spectrum").hidden = !segments;
  const needed = (FEWEST + 1) * ticks * step / 2;
  $("spectrum-says").textContent = segments
    ? `${segments} segments of ${view.number(ticks * step)} ${group === "trace" ? "µm" : "s"}` + (expected ? "; 95 % of bins lie in the band about what theory expects." : "; theory knows no spectrum of this motion.")
    : view.isWhole() ? "The run is too short for a spectrum."
    : values === null ? "Of this window the page holds too few ticks for a spectrum."
      : `A spectrum needs a window of ${Number(needed.toPrecision(2))} ${group === "trace" ? "µm" : "s"} or more.`;
  if (!segments) return;
  const bins = Array.from({ length: ticks / 2 - 2 }, (_, i) => i + 2);
  const [low, high] = view.strayOf(segments);
  const positive = (value) => (value > 0 ? value : null);
  const curves = [bins.map((bin) => positive(seen[bin]))];
  if (expected) for (const factor of [low, high, 1]) curves.push(bins.map((bin) => positive(factor * expected[bin])));
  draw("spectrum", [bins.map((bin) => (2 * Math.PI * bin) / (ticks * step)), ...curves], {
    logarithmic: true, across: [across, 44], up: [`S (${SQUARES[heard]})`, 78], name: `spectrum of the ${heard} in ${words()}`,
    series: [line("curve", 1), ...(expected ? [line("band", 0), line("band", 0), line("exact", 1.6)] : [])],
    bands: expected ? [{ series: [3, 2], fill: () => view.ink("band") }] : [],
  });
};

/** The ticks of the window in bars, null if they are few. Nothing is borne off the surface: a share of the time, and no bar. */
const inBars = (counted) => {
  const ticks = view.ticksOf(QUANTITIES[counted].group, QUANTITIES[counted].name);
  if (ticks === null || ticks.length * data.tick < 4 * data.meanLife) return null;
  const values = data.flights && counted !== "normal" ? ticks.filter((x) => x > 0) : ticks;
  const [low, high] = values.reduce(([least, most], x) => [Math.min(least, x), Math.max(most, x)], [Infinity, -Infinity]);
  const ends = low < high ? [low, high] : [low - 0.5, low + 0.5];
  const counts = new Float64Array(BARS);
  for (const x of values) counts[Math.min(Math.floor(((x - ends[0]) / (ends[1] - ends[0])) * BARS), BARS - 1)] += 1;
  return { counts, ends, rows: ticks.length };
};

const histogram = () => {
  const counted = $("counted").value;
  const { called, unit } = QUANTITIES[counted];
  const name = called.replaceAll("_", " ");
  const bars = view.isWhole() ? whole[counted] : inBars(counted);
  const on = bars === null ? 0 : bars.counts.reduce((sum, count) => sum + count, 0);
  const law = counted === "area" ? density : null;
  $("histogram").hidden = !on;
  $("histogram-says").textContent = bars === null ? "A histogram needs a window of four mean lives or more, of which the page knows each tick."
    : data.flights && counted !== "normal" ? `${view.grouped(bars.rows)} ticks; in ${Number((100 - (100 * on) / bars.rows).toPrecision(3))} % of them the slider is off the surface, which is not drawn.`
      : `${view.grouped(bars.rows)} ticks` + (law ? ", beside the exact density." : ".");
  if (!on) return;
  const [least, most] = bars.ends;
  const width = (most - least) / bars.counts.length;
  const heights = Array.from(bars.counts, (count) => count / bars.rows / width);
  const places = heights.map((_, bar) => least + (bar + 0.5) * width);
  const areas = law ? Array.from(law.subarray(0, law.length / 2)) : [];
  const joined = uPlot.join([[places, heights], ...(law ? [[areas, Array.from(law.subarray(areas.length))]] : [])]);
  draw("histogram", joined, {
    across: [`${name} (${unit})`, 44], up: [`density (1/(${unit}))`, 78], name: `histogram of the ${name} in ${words()}`,
    series: [
      { ...line("curve", 1, { fill: () => view.ink("life") }), paths: uPlot.paths.stepped({ align: 1, alignGaps: 1 }), spanGaps: true },
      ...(law ? [line("exact", 1.6, { spanGaps: true })] : []),
    ],
  });
};

const drawAll = () => [spectrum, histogram, view.drawPhase].forEach((each) => each());
let waiting = 0;
view.drawStatistics = () => {
  clearTimeout(waiting);
  waiting = setTimeout(drawAll, 120);
};
$("part").addEventListener("change", drawAll);
$("heard").addEventListener("change", spectrum);
$("counted").addEventListener("change", histogram);
