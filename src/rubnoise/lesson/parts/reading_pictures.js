'use strict';
/* The trace of which a size is read, with the bar on it; its autocorrelation; and what was read, on one ruler. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { reading } = rub;
  const { LEVELS } = reading;
  const { ink, pen, line, leftAxis, lowerAxis, heading, said } = rub.plot;
  const LEFT = 46;
  const NEAR = 16; // pixels from an end of the bar within which a finger takes it
  const LONGEST = 25; // um of the ruler
  const LEAST_ROW = 17; // pixels of a reading on the ruler
  const TRUTHS = ['filled: births; line: their share in the noise', 'births; line: noise'];
  const CANVASES = { trace: 'reading', half: 'half', ruler: 'ruler' };
  const pens = {};
  let held = null;

  const boxOf = ({ width, height }) => ({ left: LEFT, top: 18, right: width - 8, bottom: height - 18 });
  const find = (id) => document.getElementById(id);

  /** Draw what may be seen. */
  reading.draw = () => {
    if (!pens.trace.width || !reading.law) return;
    drawTrace();
    if (reading.level < LEVELS.readings) return;
    drawHalf();
    drawRuler();
  };

  /* The trace has the whole place until the other pictures may be seen. */
  function makeRoom() {
    const { dataset } = find('panel-reading');
    if (dataset.level === String(reading.level)) return;
    dataset.level = reading.level;
    reading.fit();
  }

  function drawTrace() {
    const { ctx } = pens.trace;
    pens.trace.clear();
    const box = boxOf(pens.trace);
    const { forces, tick, top, law } = reading.current();
    const title = `${law} sizes: friction force, mN`;
    const [from, to] = reading.stretch();
    const y = leftAxis(ctx, box, 0, (1.08 * top) / 1000, [`${title}; the junctions are out of sight`, title]);
    const x = lowerAxis(ctx, box, from, to, 'sliding distance, µm');
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'round';
    line(
      ctx,
      Math.ceil(from / tick),
      Math.floor(to / tick),
      (i) => x(i * tick),
      (i) => y(forces[i] / 1000),
    );
    drawBar(ctx, box, x, y);
  }

  /** Draw the bar, and over it the life of a junction that would be so long, as high as the trace is there. */
  function drawBar(ctx, box, x, y) {
    const { forces, tick } = reading.current();
    const { place, length } = reading.bar();
    const [from, to] = [place - length / 2, place + length / 2];
    const inside = forces.slice(Math.max(0, Math.ceil(from / tick)), Math.floor(to / tick) + 1);
    ctx.strokeStyle = ink.accent;
    ctx.lineWidth = 4;
    ctx.beginPath();
    ctx.moveTo(x(from), box.bottom - 7);
    ctx.lineTo(x(to), box.bottom - 7);
    ctx.stroke();
    ctx.lineWidth = 2;
    ctx.beginPath();
    for (const end of [from, to]) {
      ctx.moveTo(x(end), box.bottom);
      ctx.lineTo(x(end), box.top);
    }
    ctx.setLineDash([3, 4]);
    ctx.stroke();
    ctx.setLineDash([]);
    if (inside.length < 3) return;
    const foot = Math.min(inside[0], inside[inside.length - 1]);
    const high = Math.max(...inside) - foot;
    const { area } = rub.model.pulses.lens;
    ctx.lineWidth = 2.5;
    line(
      ctx,
      0,
      60,
      (i) => x(from + (i / 60) * length),
      (i) => y((foot + (high * area(i / 30, 1)) / area(1, 1)) / 1000),
    );
  }

  /** Draw the autocorrelation, and where it falls to one half. */
  function drawHalf() {
    const { ctx } = pens.half;
    pens.half.clear();
    const box = boxOf(pens.half);
    const { shared, tick, half } = reading.current();
    const y = leftAxis(ctx, box, -0.2, 1.05, ['autocorrelation of the trace', 'autocorrelation']);
    const x = lowerAxis(ctx, box, 0, (shared.length - 1) * tick, 'lag, µm');
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    line(
      ctx,
      0,
      shared.length - 1,
      (i) => x(i * tick),
      (i) => y(Math.max(-0.2, shared[i])),
    );
    ctx.strokeStyle = ctx.fillStyle = ink.second;
    ctx.setLineDash([4, 3]);
    ctx.beginPath();
    ctx.moveTo(x(0), y(0.5));
    ctx.lineTo(x(half), y(0.5));
    ctx.lineTo(x(half), y(-0.2));
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.arc(x(half), y(0.5), 4, 0, 2 * Math.PI);
    ctx.fill();
    ctx.textAlign = 'left';
    ctx.textBaseline = 'bottom';
    const room = box.right - x(half) - 7;
    const texts = [`one half at ${said(half, 3)} µm`, `½ at ${said(half, 3)}`];
    ctx.fillText(texts.find((text) => ctx.measureText(text).width < room) ?? texts[1], x(half) + 7, y(0.5) - 2);
  }

  /** Draw all that was read on one scale of diameters; with the truth, the sizes at birth and what each weighs. */
  function drawRuler() {
    const { ctx } = pens.ruler;
    pens.ruler.clear();
    const box = { ...boxOf(pens.ruler), left: 12 };
    const x = lowerAxis(ctx, box, 0, LONGEST, 'diameter, µm');
    const isTrue = reading.level >= LEVELS.truth;
    heading(ctx, box, isTrue ? TRUTHS : 'what was read');
    if (isTrue) drawSizes(ctx, box, x);
    drawMarks(ctx, box, x, isTrue);
  }

  function drawSizes(ctx, box, x) {
    const { density, largest } = reading.current();
    const cell = largest / density.length;
    const last = Math.round(LONGEST / cell) - 1;
    const draw = (values, fills) => {
      const top = Math.max(...values.slice(0, last + 1));
      const y = (i) => box.bottom - (values[i] / top) * 0.42 * (box.bottom - box.top);
      line(ctx, 0, last, (i) => x((i + 0.5) * cell), y);
      if (!fills) return;
      ctx.lineTo(x(LONGEST), box.bottom);
      ctx.lineTo(x(0), box.bottom);
      ctx.fill();
    };
    ctx.fillStyle = ink.band;
    ctx.strokeStyle = ink.band;
    draw(density, true);
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    draw(reading.weight(reading.current()), false);
  }

  /** Draw a line of its own for each reading, with its name. */
  function drawMarks(ctx, box, x, isTrue) {
    const { half, found, diameter, law } = reading.current();
    const eye = reading.noted?.(law);
    const marks = [
      eye && ['by eye', eye, ink.accent],
      ['lag', reading.byLag(half), ink.second],
      ['rubnoise', found.diameter, ink.exact, found.interval],
      isTrue && ['truth', diameter, ink.ink],
    ].filter(Boolean);
    const tall = box.bottom - box.top;
    const high = Math.max(0.55 * tall, Math.min(0.98 * tall, LEAST_ROW * marks.length)) / marks.length;
    marks.forEach(([name, value, colour, interval], i) => {
      const y = box.top + (i + 0.6) * high;
      ctx.strokeStyle = ctx.fillStyle = colour;
      ctx.lineWidth = 2;
      if (interval) {
        ctx.beginPath();
        ctx.moveTo(x(interval[0]), y);
        ctx.lineTo(x(Math.min(LONGEST, interval[1])), y);
        ctx.stroke();
      }
      ctx.beginPath();
      ctx.arc(x(Math.min(LONGEST, value)), y, 4, 0, 2 * Math.PI);
      ctx.fill();
      ctx.fillStyle = ink.ink;
      ctx.textBaseline = 'middle';
      const end = Math.max(value, interval ? interval[1] : 0);
      const isRight = x(end) < 0.7 * box.right;
      ctx.textAlign = isRight ? 'left' : 'right';
      ctx.fillText(`${name} ${said(value, 3)}`, isRight ? x(end) + 8 : x(value) - 8, y);
    });
    ctx.textBaseline = 'top';
  }

  /* A finger takes the nearer end of the bar and stretches it, or moves the trace along below the bar. */
  function take(event) {
    const { place, length } = reading.bar();
    const at = placeOf(event);
    const ends = [place - length / 2, place + length / 2].map((end) => Math.abs(at.x(end) - at.pixels));
    held = { end: Math.min(...ends) < NEAR, from: at.distance, place };
    event.target.setPointerCapture(event.pointerId);
  }

  function drag(event) {
    if (!held) return;
    const at = placeOf(event);
    if (held.end) reading.lay({ length: 2 * Math.abs(at.distance - reading.bar().place) });
    else reading.lay({ place: reading.bar().place - (at.distance - held.from) });
    if (!held.end) held.from = placeOf(event).distance;
  }

  function placeOf(event) {
    const { canvas, zoom, width } = pens.trace;
    const pixels = (event.clientX - canvas.getBoundingClientRect().left) / zoom;
    const [from, to] = reading.stretch();
    const wide = width - 8 - LEFT;
    const x = (distance) => LEFT + ((distance - from) / (to - from)) * wide;
    return { pixels, x, distance: from + ((pixels - LEFT) / wide) * (to - from) };
  }

  reading.begin = () => {
    for (const [name, id] of Object.entries(CANVASES)) pens[name] = pen(find(id));
    rub.on('reading', makeRoom);
    const { canvas } = pens.trace;
    canvas.addEventListener('pointerdown', take);
    canvas.addEventListener('pointermove', drag);
    for (const end of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(end, () => {
        held = null;
      });
    }
  };

  reading.fit = () => Object.values(pens).forEach((each) => each.fit());
})();
