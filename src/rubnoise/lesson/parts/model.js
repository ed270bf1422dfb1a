/* The contact: sizes and calibration. Lengths in um, areas in um^2, as everywhere on the page. */
const { normalDensity, normalMass, panels, evenly, ordered } = rub.numbers;
const { pulses, pulseOf } = rub.model;
const STEP = 1e-6; // of a mean diameter, for a slope

/** Diameters Normal(mean, std), drawn again while not positive; std 0 makes them all equal. */
class Sizes {
  constructor(mean, std) {
    this.mean = mean;
    this.std = std;
    this.mass = std > 0 ? normalMass(mean / std) : 1;
    this.low = std > 0 ? Math.max(0, mean - 8.3 * std) : mean;
    this.high = mean + 8.3 * std;
    this.rules = new Map();
  }

  /** Return E[d^n] of the law as it is drawn: m_n = mean m_(n-1) + (n - 1) std^2 m_(n-2). */
  moment(power) {
    if (this.std === 0) return this.mean ** power;
    let before = 1;
    let current = this.mean + (this.std * normalDensity(this.mean / this.std)) / this.mass;
    if (power === 0) return before;
    for (let n = 2; n <= power; n += 1) {
      [before, current] = [current, this.mean * current + (n - 1) * this.std ** 2 * before];
    }
    return current;
  }

  /** Return the density in 1/um at a positive diameter. */
  density(diameter) {
    return normalDensity((diameter - this.mean) / this.std) / (this.std * this.mass);
  }

  /** Return diameters (nodes) and probabilities (weights), on at least so many panels, kept for the next call. */
  rule(count) {
    const known = this.rules.get(count);
    if (known) return known;
    const rule =
      this.std === 0
        ? { nodes: Float64Array.of(this.mean), weights: Float64Array.of(1) }
        : this.weighed(panels(evenly(this.low, this.high, Math.max(5, count)), 12));
    this.rules.set(count, rule);
    return rule;
  }

  /**
   * Return a rule whose panels end at the cuts, for what is not smooth there; from the first cut upwards it may begin
   * as a root does.
   */
  cutRule(cuts) {
    if (this.std === 0 || !cuts.some((cut) => cut > this.low && cut < this.high)) return this.rule(5);
    const [root] = cuts;
    const inside = cuts.filter((cut) => cut > this.low && cut < this.high);
    const edges = ordered([...evenly(this.low, this.high, 5), ...inside]);
    const count = 16 * (edges.length - 1);
    const rule = { nodes: new Float64Array(count), weights: new Float64Array(count) };
    for (let i = 0; i + 1 < edges.length; i += 1) {
      const panel = panels([edges[i], edges[i + 1]], 16, edges[i] === root);
      rule.nodes.set(panel.nodes, 16 * i);
      rule.weights.set(panel.weights, 16 * i);
    }
    return this.weighed(rule);
  }

  weighed({ nodes, weights }) {
    nodes.forEach((d, i) => {
      weights[i] *= this.density(d);
    });
    return { nodes, weights };
  }

  /** Return one diameter. */
  draw(random) {
    if (this.std === 0) return this.mean;
    for (;;) {
      const diameter = this.mean + this.std * random.normal();
      if (diameter > 0) return diameter;
    }
  }
}

/** Diameters of the law d/s^2 exp(-d^2/(2 s^2)), of two rough surfaces whose heights end as exponentials do. */
class RayleighSizes extends Sizes {
  constructor(mean) {
    super(mean, mean * Math.sqrt(4 / Math.PI - 1));
    this.square = (2 / Math.PI) * mean * mean;
    this.low = 0;
    this.high = 9 * Math.sqrt(this.square);
  }

  moment(power) {
    let value = power % 2 ? this.mean : 1;
    for (let n = power % 2 ? 3 : 2; n <= power; n += 2) value *= n * this.square;
    return value;
  }

  density(diameter) {
    return (diameter / this.square) * Math.exp((-0.5 * diameter * diameter) / this.square);
  }

  draw(random) {
    return Math.sqrt(2 * this.square * random.exponential());
  }

  /** P(diameter <= d) among those found alive: erf(t) - (2/sqrt(pi)) t exp(-t^2), t^2 = d^2/(2 s^2). */
  aliveShare(diameter) {
    const z = diameter / Math.sqrt(this.square);
    return 2 * normalMass(z) - 1 - 2 * z * normalDensity(z);
  }
}

/**
 * Return d_m for a world, or NaN where `matched` has none: `paper` sqrt(A_rm / (0.327 N_jm)), for the lens alone,
 * `exact` with the pulse's own life mean, `matched` the larger root of N_jm lifeMean E[d^3] / d_m = A_rm.
 */
function calibratedDiameter(world) {
  const wanted = world.meanArea / world.meanCount;
  const { lifeMean } = pulseOf(world);
  /* E[d^3] = (6/pi) d_m^3 of Rayleigh's law. */
  if (world.sizes === 'rayleigh') return Math.sqrt((wanted * Math.PI) / (6 * lifeMean));
  if (world.calibration === 'paper' && pulseOf(world) === pulses.lens) return Math.sqrt(wanted / 0.327);
  if (world.calibration !== 'matched' || world.spread === 0) return Math.sqrt(wanted / lifeMean);
  return matchedDiameter(wanted / lifeMean, world.spread);
}

/* Newton's method from above: what is left is convex, and where it has no root there is a step down a falling branch. */
function matchedDiameter(wanted, std) {
  const left = (mean) => new Sizes(mean, std).moment(3) / mean - wanted;
  let mean = Math.sqrt(wanted);
  for (let i = 0; i < 60; i += 1) {
    const slope = (left(mean * (1 + STEP)) - left(mean)) / (STEP * mean);
    if (!(slope > 0)) return NaN;
    mean -= left(mean) / slope;
  }
  return Math.abs(left(mean)) < 1e-9 * wanted ? mean : NaN;
}

/**
 * Return what follows from the settings at once: d_m, sizes, mean life 2 d_m (off the centre line (pi/2) d_m), birth
 * spacing and rate, pulse.
 */
function contact(world) {
  const diameter = calibratedDiameter(world);
  const pulse = pulseOf(world);
  const meanLife = pulse.meanLife * diameter;
  const spacing = meanLife / world.meanCount;
  const sizes = world.sizes === 'rayleigh' ? new RayleighSizes(diameter) : new Sizes(diameter, world.spread);
  return { diameter, sizes, spacing, birthRate: 1 / spacing, meanLife, pulse };
}

Object.assign(rub.model, { calibratedDiameter, contact });
