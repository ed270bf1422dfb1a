/* A picture by uPlot in a place of the page, in the inks of the page, and what is drawn on one by hand. */
const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

const axis = ([label, size], more) => ({
  label, size, labelSize: 22, font: "12px system-ui", labelFont: "13px system-ui", stroke: () => ink("ink"),
  grid: { stroke: () => ink("grid"), width: 1 }, ticks: { stroke: () => ink("grid"), width: 1 }, ...more,
});

/** A line of an ink. */
view.line = (name, width, more = {}) => ({ stroke: () => ink(name), width, points: { show: false }, ...more });

/** Numbers of an axis with logarithms, and of one whose numbers may be large or small. */
view.numbered = { values: (_, ticks) => ticks.map((value) => (value === null ? "" : view.number(value))) };

/** Make a picture: its name, and across and up a label and a size; the rest is as uPlot has it. */
view.plot = (place, values, { name, across, up, axes = {}, scales = {}, series, ...more }) => {
  const chart = new uPlot({
    width: place.clientWidth, legend: { show: false }, cursor: { show: false },
    scales: { ...scales, x: { time: false, ...scales.x } }, axes: [axis(across, axes), axis(up, axes)], series: [{}, ...series], ...more,
  }, values, place);
  const picture = chart.root.querySelector("canvas");
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", name);
  return chart;
};

/** Draw within the frame of a picture what may leave it. */
const clipped = ({ ctx, bbox }, draw) => {
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(ctx);
  ctx.restore();
};

/** Shade a picture from one place to another. */
const shaded = (chart, begin, end, colour) => {
  const { ctx, bbox } = chart;
  const left = Math.max(chart.valToPos(begin, "x", true), bbox.left);
  const right = Math.min(chart.valToPos(end, "x", true), bbox.left + bbox.width);
  if (right <= left) return;
  ctx.fillStyle = colour;
  ctx.fillRect(left, bbox.top, Math.max(right - left, 1), bbox.height);
};

/** Draw an upright line at a place, if it is in the picture. */
const upright = (chart, place) => {
  const { ctx, bbox } = chart;
  const x = chart.valToPos(place, "x", true);
  if (x < bbox.left || x > bbox.left + bbox.width) return;
  ctx.strokeStyle = ink("ink");
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
};

/** Draw a level line at a value, in an ink. */
const level = ({ ctx, bbox, valToPos }, value, name, dash = []) => {
  const y = valToPos(value, "y", true);
  ctx.strokeStyle = ink(name);
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.setLineDash(dash);
  ctx.beginPath();
  ctx.moveTo(bbox.left, y);
  ctx.lineTo(bbox.left + bbox.width, y);
  ctx.stroke();
  ctx.setLineDash([]);
};

/* From dark blue to yellow, with a lightness that rises evenly, so that it can be read in grey too. */
view.rising = ["#1b2a6b", "#1f4287", "#22599a", "#2a70a3", "#3a86a2", "#549a98", "#75ac88", "#9bbc77", "#c3c968", "#ecd15e"];
Object.assign(view, { ink, clipped, shaded, upright, level });
