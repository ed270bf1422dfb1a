'use strict';
/* The traces under the stage, drawn as they grow: real contact area, count, force, displacement. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line, leftAxis, lowerAxis } = rub.plot;
  const LEFT = 46;
  const traces = { pens: {} };

  /** Return the stretch of distance on show: the last lives up to now, or the first ones. */
  function stretch() {
    const { distance, window } = rub.run;
    return distance < window ? [0, window] : [distance - window, distance];
  }

  function boxOf({ width, height }) {
    return { left: LEFT, top: 18, right: width - 8, bottom: height - 18 };
  }

  /** Draw what is exact: a line at the mean, a band of one standard deviation about it; and the mean so far, dashed. */
  function drawExact(ctx, box, y, mean, std, seen) {
    ctx.fillStyle = ink.band;
    ctx.fillRect(box.left, y(mean + std), box.right - box.left, y(mean - std) - y(mean + std));
    level(ctx, box, y(mean), ink.exact, []);
    level(ctx, box, y(seen), ink.ink, [5, 4]);
  }

  function level(ctx, box, y, colour, dashes) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5;
    ctx.setLineDash(dashes);
    ctx.beginPath();
    ctx.moveTo(box.left, y);
    ctx.lineTo(box.right, y);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /** Draw one column of the trace over the stretch; steps for what jumps. */
  function drawColumn(ctx, box, x, y, values, colour) {
    const { tick } = rub.run.trace;
    const [from] = stretch();
    const first = Math.max(0, Math.ceil(from / tick));
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'round';
    line(
      ctx,
      first,
      rub.run.ticksSeen,
      (i) => x(i * tick),
      (i) => y(values[i]),
    );
  }

  function frame(name, low, high, title) {
    const state = traces.pens[name];
    state.clear();
    const box = boxOf(state);
    const y = leftAxis(state.ctx, box, low, high, title);
    const [from, to] = stretch();
    const x = lowerAxis(state.ctx, box, from, to, 'sliding distance, µm');
    return { ctx: state.ctx, box, x, y };
  }

  /** Return the largest area on show, in um^2. */
  traces.topArea = () => {
    const { areaMean, areaStd } = rub.exact();
    return Math.max(1.25 * areaMean, areaMean + 4.5 * areaStd);
  };

  function drawArea(seen) {
    const { areaMean, areaStd } = rub.exact();
    const { ctx, box, x, y } = frame('area', 0, traces.topArea(), 'real contact area, µm²');
    drawStack(ctx, box);
    drawExact(ctx, box, y, areaMean, areaStd, seen.areaMean);
    drawColumn(ctx, box, x, y, rub.run.trace.area, ink.ink);
  }

  function drawStack(ctx, box) {
    const { scale } = traces.pens.area;
    const [begin] = stretch();
    const columns = Math.max(1, Math.round((box.right - box.left) * scale));
    const spacing = rub.run.window / columns;
    const height = Math.max(1, Math.round((box.bottom - box.top) * scale));
    const { stack } = rub;
    if (
      stack.width !== columns ||
      stack.height !== height ||
      stack.spacing !== spacing ||
      stack.top !== traces.topArea()
    ) {
      stack.begin(columns, height, traces.topArea(), spacing);
    }
    const to = Math.floor(rub.run.distance / spacing) - 1;
    const from = Math.max(0, to - columns + 1);
    if (to < from) return;
    stack.until(from, to);
    const x = box.left + ((from * spacing - begin) / rub.run.window) * (box.right - box.left);
    stack.paint(ctx, from, to, x, box.top, 1 / scale);
  }

  function drawCount(seen) {
    const { countMean, countStd } = rub.exact();
    const top = Math.ceil(Math.max(countMean + 4.5 * countStd, 1.3 * countMean, 2));
    const { ctx, box, x, y } = frame('count', 0, top, 'live junctions');
    drawExact(ctx, box, y, countMean, countStd, seen.countMean);
    drawColumn(ctx, box, x, y, rub.run.trace.count, ink.ink);
  }

  function drawForce(seen) {
    const { forceMean, forceStd } = rub.exact();
    const top = rub.world.strength * traces.topArea() * 1e-3;
    const { ctx, box, x, y } = frame('force', 0, top, 'friction force, mN');
    const milli = (value) => y(value * 1e-3);
    drawExact(ctx, box, milli, forceMean, forceStd, seen.areaMean * rub.world.strength);
    drawColumn(ctx, box, x, milli, rub.run.trace.force, ink.ink);
  }

  function drawSlider(seen) {
    const { displacementMean, displacementStd } = rub.exact();
    const reach = Math.max(3.5 * displacementStd, 0.05 * displacementMean);
    const { ctx, box, x, y } = frame(
      'slider',
      displacementMean - reach,
      displacementMean + reach,
      'slider displacement, µm',
    );
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    ctx.clip();
    drawExact(ctx, box, y, displacementMean, displacementStd, seen.displacementMean);
    drawColumn(ctx, box, x, y, rub.run.trace.displacement, ink.ink);
    ctx.restore();
  }

  /** Draw all traces. */
  traces.draw = (seen) => {
    drawArea(seen);
    drawCount(seen);
    drawForce(seen);
    drawSlider(seen);
  };

  /** Take over the canvases. */
  traces.begin = (canvases) => {
    for (const [name, canvas] of Object.entries(canvases)) traces.pens[name] = pen(canvas);
  };

  traces.fit = () => {
    Object.values(traces.pens).forEach((state) => state.fit());
    rub.stack.forget();
  };

  traces.stretch = stretch;
  rub.traces = traces;
})();
