/* The trace of which a size is read, with the bar on it; its autocorrelation; and what was read, on one ruler. */
const { reading } = rub;
const { LEVELS } = reading;
const { ink, picture, said } = rub.plot;
const NEAR = 16; // pixels from an end of the bar within which a finger takes it
const LONGEST = 25; // um of the ruler
const LEAST_ROW = 17; // pixels of a reading on the ruler
const TRUTHS = ['filled: births; line: their share in the noise', 'births; line: noise'];
let held = null;

/* The trace has the whole place until the other pictures may be seen. */
function makeRoom() {
  const { dataset } = document.getElementById('panel-reading');
  if (dataset.level === String(reading.level)) return;
  dataset.level = reading.level;
  rub.fitAll();
}

const trace = picture('reading', (p) => {
  if (!reading.law) return;
  p.frame();
  const { forces, tick, top, law } = reading.current();
  const title = `${law} sizes: friction force, mN`;
  const [from, to] = reading.stretch();
  const titles = [`${title}; the junctions are out of sight`, title];
  p.axes([0, (1.08 * top) / 1000, titles], [from, to, 'sliding distance, µm']);
  const [x, y] = [(i) => p.x(i * tick), (i) => p.y(forces[i] / 1000)];
  p.curve(Math.ceil(from / tick), Math.floor(to / tick), x, y);
  drawBar(p);
});

/** Draw the bar, and over it the life of a junction that would be so long, as high as the trace is there. */
function drawBar(p) {
  const { forces, tick } = reading.current();
  const { place, length } = reading.bar();
  const [from, to] = [place - length / 2, place + length / 2];
  const inside = forces.slice(Math.max(0, Math.ceil(from / tick)), Math.floor(to / tick) + 1);
  const colour = ink.accent;
  p.level(p.box.bottom - 7, { colour, width: 4 }, { left: p.x(from), right: p.x(to) });
  for (const end of [from, to]) p.upright(p.x(end), { colour, width: 2, dash: [3, 4] });
  if (inside.length < 3) return;
  const foot = Math.min(inside[0], inside[inside.length - 1]);
  const high = Math.max(...inside) - foot;
  const { area } = rub.model.pulses.lens;
  const y = (i) => p.y((foot + (high * area(i / 30, 1)) / area(1, 1)) / 1000);
  p.curve(0, 60, (i) => p.x(from + (i / 60) * length), y, { colour, width: 2.5 });
}

/** Draw the autocorrelation, and where it falls to one half. */
picture('half', (p) => {
  if (!reading.law) return;
  p.frame();
  const { shared, tick, half } = reading.current();
  const last = shared.length - 1;
  p.axes([-0.2, 1.05, ['autocorrelation of the trace', 'autocorrelation']], [0, last * tick, 'lag, µm']);
  const y = (i) => p.y(Math.max(-0.2, shared[i]));
  p.curve(0, last, (i) => p.x(i * tick), y);
  const [left, x, up] = [p.x(0), p.x(half), p.y(0.5)];
  const corner = [[[left, up], [x, up], [x, p.y(-0.2)]]];
  p.lines(corner, { colour: ink.second, dash: [4, 3] });
  p.dot(x, up, ink.second);
  const texts = [`one half at ${said(half, 3)} µm`, `½ at ${said(half, 3)}`];
  const fits = texts.find((text) => p.ctx.measureText(text).width < p.box.right - x - 7);
  p.text(fits ?? texts[1], x + 7, up - 2, 'left', 'bottom', ink.second);
});

/** Draw all that was read on one scale of diameters; with the truth, the sizes at birth and what each weighs. */
picture('ruler', (p) => {
  if (!reading.law) return;
  p.frame(12);
  p.across(0, LONGEST, 'diameter, µm');
  const isTrue = reading.level >= LEVELS.truth;
  p.heading(isTrue ? TRUTHS : 'what was read');
  if (isTrue) drawSizes(p);
  drawMarks(p, isTrue);
});

function drawSizes(p) {
  const { density, largest } = reading.current();
  const { box } = p;
  const cell = largest / density.length;
  const outline = (all) => (ctx) => {
    const values = all.slice(0, Math.round(LONGEST / cell));
    const unit = (0.42 * (box.bottom - box.top)) / Math.max(...values);
    values.forEach((value, i) => ctx.lineTo(p.x((i + 0.5) * cell), box.bottom - value * unit));
  };
  p.fill((ctx) => {
    ctx.moveTo(p.x(0), box.bottom);
    outline(density)(ctx);
    ctx.lineTo(p.x(LONGEST), box.bottom);
  }, ink.band);
  p.stroke(outline(reading.weight(reading.current())));
}

/** Draw a line of its own for each reading, with its name. */
function drawMarks(p, isTrue) {
  const { half, found, diameter, law } = reading.current();
  const { box } = p;
  const eye = reading.noted?.(law);
  const marks = [
    eye && ['by eye', eye, ink.accent],
    ['lag', reading.byLag(half), ink.second],
    ['rubnoise', found.diameter, ink.exact, found.interval],
    isTrue && ['truth', diameter, ink.ink],
  ].filter(Boolean);
  const tall = box.bottom - box.top;
  const high = Math.max(0.55 * tall, Math.min(0.98 * tall, LEAST_ROW * marks.length)) / marks.length;
  const x = (value) => p.x(Math.min(LONGEST, value));
  marks.forEach(([name, value, colour, interval], i) => {
    const y = box.top + (i + 0.6) * high;
    if (interval) p.level(y, { colour, width: 2 }, { left: x(interval[0]), right: x(interval[1]) });
    p.dot(x(value), y, colour);
    const end = p.x(Math.max(value, interval ? interval[1] : 0));
    const isRight = end < 0.7 * box.right;
    const text = `${name} ${said(value, 3)}`;
    p.text(text, isRight ? end + 8 : p.x(value) - 8, y, isRight ? 'left' : 'right', 'middle');
  });
}

/* A finger takes the nearer end of the bar and stretches it, or moves the trace along below the bar. */
function take(event) {
  const { place, length } = reading.bar();
  const { pixels, distance } = placeOf(event);
  const ends = [place - length / 2, place + length / 2].map((end) => Math.abs(trace.x(end) - pixels));
  held = { end: Math.min(...ends) < NEAR, from: distance };
}

function drag(event) {
  const { distance } = placeOf(event);
  const { place } = reading.bar();
  if (held.end) return reading.lay({ length: 2 * Math.abs(distance - place) });
  reading.lay({ place: place - (distance - held.from) });
  held.from = placeOf(event).distance;
  return undefined;
}

function placeOf(event) {
  const { canvas, zoom, box } = trace;
  const pixels = (event.clientX - canvas.getBoundingClientRect().left) / zoom;
  const [from, to] = reading.stretch();
  return { pixels, distance: from + ((pixels - box.left) / (box.right - box.left)) * (to - from) };
}

reading.begin = () => {
  rub.on('reading', makeRoom);
  rub.dragging(trace.canvas, take, drag);
};
