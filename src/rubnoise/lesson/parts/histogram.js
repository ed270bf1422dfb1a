'use strict';
/* How often each area has been met so far, beside the trace of the area and on the same scale. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, picture } = rub.plot;
  const BINS = 48;
  const RESTED = 200; // ms
  const POINTS = 240; // of a density
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
  function draw(p) {
    update();
    const box = p.frame(4, 4);
    p.heading('how often');
    const { areaStd } = rub.exact();
    const peak = areaStd > 0 ? (0.5 / areaStd) * 1.05 : 1;
    const bin = histogram.top / BINS;
    p.x = (density) => box.left + Math.min(1, density / peak) * (box.right - box.left);
    p.y = (area) => box.bottom - (area / histogram.top) * (box.bottom - box.top);
    histogram.counts.forEach((count, i) => {
      const [top, bottom] = [p.y((i + 1) * bin), p.y(i * bin) - 0.5];
      p.shade(box.left, p.x(count / (histogram.ticks * bin)), ink.band, { top, bottom });
    });
    const known = rub.world.births === 'poisson' ? exactDensity() : null;
    if (known && !rub.readout.veiled()) drawLaws(p, bin, known);
  }

  /** Draw the exact density of births at random, and dashed the bell curve; other births have neither here. */
  function drawLaws(p, bin, known) {
    const area = (i) => (i / POINTS) * histogram.top;
    const y = (i) => p.y(area(i));
    p.curve(0, POINTS, (i) => p.x(bell(area(i))), y, { colour: ink.exact, dash: [3, 3] });
    p.curve(0, POINTS, (i) => p.x(known[i]), y, { colour: ink.exact });
    drawAtom(p, bin);
  }

  /** Draw the chance that no junction is in contact, spread over one bar, and say it where it can be seen. */
  function drawAtom(p, bin) {
    const atom = rub.theory.areaAtom(rub.exact().contact);
    if (atom < 1e-3) return;
    p.level(p.y(0), { colour: ink.exact, width: 3 }, { left: p.box.left, right: p.x(atom / bin) });
    const said = `none: ${rub.plot.said(100 * atom, 2)} %`;
    p.text(said, p.box.right, p.box.bottom + 3, 'right', 'top', ink.exact);
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

  picture('histogram', draw);
})();
