'use strict';
/* How often each area has been met so far, beside the trace of the area and on the same scale. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line } = rub.plot;
  const BINS = 48;
  const RESTED = 200; // ms
  const histogram = { counts: new Float64Array(BINS), ticks: 0, top: 0, trace: null };

  /** Count the ticks passed since the last time, or all of them where the run has gone back or is another. */
  function update() {
    const { trace, ticksSeen } = rub.run;
    const top = rub.traces.topArea();
    if (trace !== histogram.trace || ticksSeen + 1 < histogram.ticks || top !== histogram.top) {
      histogram.counts.fill(0);
      Object.assign(histogram, { ticks: 0, top, trace });
    }
    for (; histogram.ticks <= ticksSeen; histogram.ticks += 1) {
      histogram.counts[Math.min(BINS - 1, Math.floor((BINS * trace.area[histogram.ticks]) / top))] += 1;
    }
  }

  /** Return the normal density with the exact mean and standard deviation: what many junctions tend to. */
  function bell(area) {
    const { areaMean, areaStd } = rub.exact();
    return rub.numbers.normalDensity((area - areaMean) / areaStd) / areaStd;
  }

  /** Draw the bars, and what is exact over them. */
  histogram.draw = () => {
    update();
    const { ctx, width, height } = histogram.pen;
    histogram.pen.clear();
    const box = { left: 4, top: 18, right: width - 4, bottom: height - 18 };
    rub.plot.heading(ctx, box, 'how often');
    const { areaStd } = rub.exact();
    const peak = areaStd > 0 ? (0.5 / areaStd) * 1.05 : 1;
    const bin = histogram.top / BINS;
    const x = (density) => box.left + Math.min(1, density / peak) * (box.right - box.left);
    const y = (area) => box.bottom - (area / histogram.top) * (box.bottom - box.top);
    ctx.fillStyle = ink.band;
    for (let i = 0; i < BINS; i += 1) {
      const density = histogram.counts[i] / (histogram.ticks * bin);
      ctx.fillRect(box.left, y((i + 1) * bin), x(density) - box.left, y(i * bin) - y((i + 1) * bin) - 0.5);
    }
    const known = rub.world.births === 'poisson' ? exactDensity() : null;
    if (known && !rub.readout.veiled()) drawLaws(ctx, box, x, y, bin, known);
  };

  /** Draw the exact density of births at random, and dashed the bell curve; other births have neither here. */
  function drawLaws(ctx, box, x, y, bin, known) {
    const at = (i) => (i / 240) * histogram.top;
    ctx.strokeStyle = ink.exact;
    ctx.lineWidth = 1.5;
    ctx.setLineDash([3, 3]);
    line(
      ctx,
      0,
      240,
      (i) => x(bell(at(i))),
      (i) => y(at(i)),
    );
    ctx.setLineDash([]);
    line(
      ctx,
      0,
      240,
      (i) => x(known[i]),
      (i) => y(at(i)),
    );
    drawAtom(ctx, box, x, y, bin);
  }

  /** Draw the chance that no junction is in contact, spread over one bar, and say it where it can be seen. */
  function drawAtom(ctx, box, x, y, bin) {
    const atom = rub.theory.areaAtom(rub.exact().contact);
    if (atom < 1e-3) return;
    ctx.strokeStyle = ink.exact;
    ctx.lineWidth = 3;
    ctx.beginPath();
    ctx.moveTo(box.left, y(0));
    ctx.lineTo(x(atom / bin), y(0));
    ctx.stroke();
    ctx.fillStyle = ink.exact;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'top';
    ctx.fillText(`none: ${rub.plot.said(100 * atom, 2)} %`, box.right, box.bottom + 3);
  }

  /* Computed once for each setting, and not before a knob has come to rest: it takes longer than a frame. */
  function exactDensity() {
    const exact = rub.exact();
    if (histogram.of !== exact) {
      Object.assign(histogram, { of: exact, density: null });
      clearTimeout(histogram.waiting);
      histogram.waiting = setTimeout(compute, RESTED, exact, histogram.top);
    }
    return histogram.density;
  }

  function compute(exact, top) {
    if (histogram.of !== exact) return;
    histogram.density = rub.theory.areaDensity(exact.contact, top);
    rub.emit('density', top);
  }

  histogram.begin = (canvas) => {
    histogram.pen = pen(canvas);
  };

  rub.histogram = histogram;
})();
