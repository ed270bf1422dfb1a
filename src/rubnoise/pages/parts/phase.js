/* The phase plane: velocity over displacement of the window, or the time that the whole run spends in each cell. */
const MOST = 20000;
const figure = document.getElementById("phase");
let chart = null;
let shown = null;

/** Each cell of the plane, the darker the more ticks are in it, in logarithms. */
const cells = (ctx, { across: count, place, velocity, counts }, x, y) => {
  const ticks = view.unpacked(counts);
  const most = Math.log1p(ticks.reduce((a, b) => Math.max(a, b), 1));
  const at = ([low, high], part) => low + (high - low) * part;
  ticks.forEach((tick, cell) => {
    const [column, row] = [cell % count, Math.floor(cell / count)];
    const [left, right] = [column, column + 1].map((one) => x(at(place, one / count)));
    const [bottom, top] = [row, row + 1].map((one) => y(at(velocity, (one * count) / ticks.length)));
    ctx.globalAlpha = Math.log1p(tick) / most;
    ctx.fillRect(left, top, right - left, bottom - top);
  });
  ctx.globalAlpha = 1;
};

const draw = (one) => view.clipped(one, (ctx) => {
  const [x, y] = ["x", "y"].map((axis) => (value) => one.valToPos(value, axis, true));
  const { whole, slider, first, last, levels } = shown;
  levels.forEach((v, i) => view.level(one, v, "grid", i ? [5, 4] : []));
  ctx.strokeStyle = ctx.fillStyle = view.ink("curve");
  if (whole) return cells(ctx, whole, x, y);
  const step = Math.max(1, Math.ceil((last - first) / MOST));
  ctx.beginPath();
  for (let i = first; i < last; i += step) ctx.lineTo(x(slider.displacement[i]), y(slider.velocity[i]));
  return ctx.stroke();
});

/** The least and largest displacement and velocity on show; the speed of a drive that is pushed back is among them. */
const ends = ({ whole, slider, first, last, levels }) => {
  const columns = whole ? [whole.place, whole.velocity] : [slider.displacement, slider.velocity].map((all) => all.subarray(first, last));
  return columns.map((values, up) => {
    const all = up ? [...values, ...levels] : values;
    const [low, high] = all.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
    const room = 0.03 * (high - low || 1);
    return [low - room, high + room];
  });
};

view.drawPhase = () => {
  const slider = view.groups.slider;
  const whole = view.isWhole() ? view.data.statistics.phase : null;
  figure.hidden = !slider || (!whole && !view.showsRows());
  if (figure.hidden) return;
  const [first, last] = view.rowsOf("slider", view.window.from, view.window.to);
  shown = { whole, slider, first, last, levels: view.isTimed("slider") ? [0, view.data.speed] : [0] };
  const limits = ends(shown);
  const width = Math.min(figure.clientWidth, 420);
  chart?.destroy();
  chart = view.plot(figure.querySelector("div"), limits, {
    name: "velocity over displacement", width, height: 0.8 * width, axes: view.numbered,
    across: ["displacement x (µm)", 44], up: ["velocity x′ (µm/s)", 78], series: [view.line("curve", 0)],
    scales: { x: { range: () => limits[0] }, y: { range: () => limits[1] } }, hooks: { draw: [draw] },
  });
};
