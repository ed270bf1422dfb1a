/* How real contact area is distributed where births are at random: not the bell curve, though it tends to it. */
const { chebyshev, gauss, lastWhere, normalDensity, normalMass } = rub.numbers;
const PEAK = 0.25 * Math.PI; // area at full overlap of a junction of unit diameter
const CELLS = 2 ** 14; // of the lattice, which reaches twice as far as the picture: nothing to speak of lies beyond
const CELLS_TO_TOP = 7680;
const NODES = gauss(40);

/** Return the age in half-lives, 0 to 1, at which a junction of unit diameter has an area. */
const ageAt = (pulse, area) => lastWhere((age) => pulse.area(age, 1) < area, 1);

/**
 * Return P(area <= PEAK t^3) of a junction of unit diameter found alive: its age is as likely anywhere, or off the
 * centre line its other centre in the disc about its own. A root at the peak is in closed form.
 */
function unitShare(pulse) {
  const { aliveShare = (age) => age, centred = pulse, shareBelow } = pulse;
  if (shareBelow) return (t) => (t >= 1 ? 1 : shareBelow(t));
  const ratio = chebyshev((t) => aliveShare(ageAt(centred, PEAK * t ** 3)) / (t * t), 0, 1, 24);
  return (t) => (t >= 1 ? 1 : t * t * ratio(t));
}

const normalShare = (z) => (z < 0 ? 1 - normalMass(-z) : normalMass(z));

/** Return P(diameter <= d) among the junctions found alive, of density d f(d) / E[d]. */
function aliveShare(sizes, diameter) {
  if (sizes.aliveShare) return sizes.aliveShare(diameter);
  const [from, to] = [-sizes.mean / sizes.std, (diameter - sizes.mean) / sizes.std];
  const part = sizes.mean * (normalShare(to) - normalShare(from));
  return (part - sizes.std * (normalDensity(to) - normalDensity(from))) / (sizes.mass * sizes.moment(1));
}

/** Return P(area <= a) of one junction found alive, for a in um^2: small ones at any age, others near an end. */
function liveShare({ pulse, sizes }) {
  const share = unitShare(pulse);
  if (sizes.std === 0) return (area) => share(Math.cbrt(area / (PEAK * sizes.mean ** 2)));
  return (area) => {
    const least = Math.sqrt(area / PEAK); // a disc of this diameter has the area at full overlap
    if (least >= sizes.high) return 1;
    const from = Math.max(least, sizes.low);
    const half = 0.5 * (sizes.high - from);
    let sum = 0;
    for (let i = 0; i < NODES.x.length; i += 1) {
      const diameter = from + half * (1 + NODES.x[i]);
      sum += NODES.w[i] * half * diameter * sizes.density(diameter) * share(Math.cbrt((least / diameter) ** 2));
    }
    return (least > sizes.low ? aliveShare(sizes, least) : 0) + sum / sizes.moment(1);
  };
}

/** Return P(no junction is alive) = exp(-E[N]): the atom of the area at 0. */
rub.theory.areaAtom = (contact) => Math.exp(-rub.theory.countMean(contact));

/**
 * Return the density of A_r at areas from 0 to top in um^2, in 1/um^2, for Poisson births, without the atom at 0: the
 * areas of live junctions are put on a lattice, and the law of their sum, their number Poisson, has the transform
 * exp(E[N] (phi - 1)) there. At 0 itself, where it may have no bound, the mean over half a cell of the lattice. Right
 * to 1 % of its peak for E[N] from 0.5. Source: Rice 1944, section 1.4; Feller, volume 1, section XII.2.
 */
rub.theory.areaDensity = (contact, top, count = 241) => {
  const cell = top / CELLS_TO_TOP;
  const alive = rub.theory.countMean(contact);
  const share = liveShare(contact);
  const [real, imaginary] = [new Float64Array(CELLS), new Float64Array(CELLS)];
  for (let i = 0, before = 0; i < CELLS && before < 1; i += 1) {
    const next = share((i + 0.5) * cell);
    real[i] = next - before;
    before = next;
  }
  rub.fourier(real, imaginary);
  for (let i = 0; i < CELLS; i += 1) {
    const size = Math.exp(alive * (real[i] - 1)) / CELLS;
    const phase = alive * imaginary[i];
    [real[i], imaginary[i]] = [size * Math.cos(phase), size * Math.sin(phase)];
  }
  rub.fourier(real, imaginary, 1);
  real[0] = 2 * (real[0] - rub.theory.areaAtom(contact));
  const stride = CELLS_TO_TOP / (count - 1);
  return Float64Array.from({ length: count }, (_, i) => Math.max(0, real[Math.round(i * stride)]) / cell);
};
