/* How often each area has been met so far, beside the trace of the area and on the same scale. */
const { ink, picture } = rub.plot;
const BINS = 48;
const RESTED = 200; // ms
const POINTS = 240; // of a density
const histogram = {};

const counted = rub.estimates.followed(
  () => ({ counts: new Float64Array(BINS) }),
  ({ counts, trace, about: top }, tick) => {
    counts[Math.min(BINS - 1, Math.floor((BINS * trace.area[tick]) / top))] += 1;
  },
);

/** Return the normal density with the exact mean and standard deviation: what many junctions tend to. */
function bell(area) {
  const { areaMean, areaStd } = rub.exact();
  return rub.numbers.normalDensity((area - areaMean) / areaStd) / areaStd;
}

/** Draw the bars, and what is exact over them. */
function draw(p) {
  const { counts, done, about: top } = counted(rub.traces.topArea());
  const box = p.frame(4, 4);
  p.heading('how often');
  const { areaStd } = rub.exact();
  const peak = areaStd > 0 ? (0.5 / areaStd) * 1.05 : 1;
  const bin = top / BINS;
  p.x = (density) => box.left + Math.min(1, density / peak) * (box.right - box.left);
  p.y = (area) => box.bottom - (area / top) * (box.bottom - box.top);
  counts.forEach((count, i) => {
    const ends = { top: p.y((i + 1) * bin), bottom: p.y(i * bin) - 0.5 };
    p.shade(box.left, p.x(count / (done * bin)), ink.band, ends);
  });
  const known = rub.world.births === 'poisson' ? exactDensity(top) : null;
  if (known && !rub.readout.veiled()) drawLaws(p, top, known);
}

/** Draw the exact density of births at random, and dashed the bell curve; other births have neither here. */
function drawLaws(p, top, known) {
  const area = (i) => (i / POINTS) * top;
  const y = (i) => p.y(area(i));
  p.curve(0, POINTS, (i) => p.x(bell(area(i))), y, { colour: ink.exact, dash: [3, 3] });
  p.curve(0, POINTS, (i) => p.x(known[i]), y, { colour: ink.exact });
  drawAtom(p, top / BINS);
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
function exactDensity(top) {
  const exact = rub.exact();
  if (histogram.of !== exact) {
    Object.assign(histogram, { of: exact, density: null });
    clearTimeout(histogram.waiting);
    histogram.waiting = setTimeout(compute, RESTED, exact, top);
  }
  return histogram.density;
}

function compute(exact, top) {
  if (histogram.of !== exact) return;
  histogram.density = rub.theory.areaDensity(exact.contact, top);
  rub.emit('density', top);
}

picture('histogram', draw);
