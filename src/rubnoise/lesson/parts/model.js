'use strict';
/* The contact: pulses, sizes, calibration. Lengths in um, areas in um^2, as everywhere on the page. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { chebyshev, normalDensity, normalMass, panels, evenly, ordered } = rub.numbers;

  /**
   * Rising half of the lens of unit diameter over u^1.5, and its integral over u^2.5: the series of sqrt(u (2 - u))
   * integrated term by term, once and twice.
   */
  function risingSeries(u, twice) {
    let factor = Math.SQRT2;
    let sum = 0;
    for (let k = 0; k < 60; k += 1) {
      sum += factor / ((k + 1.5) * (twice ? k + 2.5 : 1));
      factor *= ((k - 0.5) / (k + 1)) * (u / 2);
    }
    return sum;
  }

  const rising = chebyshev((u) => risingSeries(u, false), 0, 1, 15);
  const risingIntegral = chebyshev((u) => risingSeries(u, true), 0, 1, 15);

  /** Area of the lens: A = d^2 a(s/d), a(u) = (acos(1 - u) - (1 - u) sqrt(u (2 - u))) / 2 and its mirror image. */
  function lensArea(sinceBirth, diameter) {
    const u = Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter;
    return u > 0 ? diameter * diameter * u * Math.sqrt(u) * rising(u) : 0;
  }

  /** Integral of the lens from its birth on, in um^3: d^3 times the antiderivative, mirrored after mid-life. */
  function lensSum(sinceBirth, diameter) {
    const u = Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter;
    const half = u > 0 ? u * u * Math.sqrt(u) * risingIntegral(u) : 0;
    return diameter ** 3 * (sinceBirth <= diameter ? half : 2 / 3 - half);
  }

  /** Integral of the triangle from its birth on, in um^3. */
  function triangleSum(sinceBirth, diameter) {
    const u = Math.max(0, Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter);
    const half = (Math.PI / 8) * u * u;
    return diameter ** 3 * (sinceBirth <= diameter ? half : Math.PI / 4 - half);
  }

  /** Area of Rabinowicz's triangle: (pi/4) d (d - |d - s|). */
  function triangleArea(sinceBirth, diameter) {
    return Math.max(0, 0.25 * Math.PI * diameter * Math.min(sinceBirth, 2 * diameter - sinceBirth));
  }

  /** Integral of the parabola from its birth on, in um^3. */
  function parabolaSum(sinceBirth, diameter) {
    const s = Math.min(Math.max(0, sinceBirth), 2 * diameter);
    return (Math.PI / 4) * s * s * (diameter - s / 3);
  }

  /** Area of the parabola, which rough surfaces have: (pi/4) s (2d - s). */
  function parabolaArea(sinceBirth, diameter) {
    return Math.max(0, 0.25 * Math.PI * sinceBirth * (2 * diameter - sinceBirth));
  }

  /** Return c_n of the parabola, 2 (pi/4)^n times 2j/(2j + 1) for j = 1 to n. */
  function parabolaIntegral(power) {
    let product = 2 * (Math.PI / 4) ** power;
    for (let j = 1; j <= power; j += 1) product *= (2 * j) / (2 * j + 1);
    return product;
  }

  const halfTurn = panels([0, Math.PI / 2], 32);

  /** Return c_n of the lens, where the integral of A^n over a life is c_n d^(2n+1); s = d (1 - cos theta). */
  function lensIntegral(power) {
    const term = (t) => (0.5 * (t - Math.sin(t) * Math.cos(t))) ** power * Math.sin(t);
    return 2 * halfTurn.nodes.reduce((sum, t, i) => sum + halfTurn.weights[i] * term(t), 0);
  }

  const pulses = {
    lens: { area: lensArea, sum: lensSum, lifeIntegral: lensIntegral, lifeMean: 1 / 3, meanLife: 2, tail: [4, 4] },
    triangle: {
      area: triangleArea,
      sum: triangleSum,
      lifeIntegral: (power) => (2 * (Math.PI / 4) ** power) / (power + 1),
      lifeMean: Math.PI / 8,
      meanLife: 2,
      tail: [0.375 * Math.PI ** 2, 4],
    },
    parabola: {
      area: parabolaArea,
      sum: parabolaSum,
      lifeIntegral: parabolaIntegral,
      lifeMean: Math.PI / 6,
      meanLife: 2,
      tail: [0.5 * Math.PI ** 2, 4],
      shareBelow: (t) => 1 - Math.sqrt(1 - t ** 3),
    },
  };

  /** Return the pulse of a world; that of lenses off the centre line is in off_centre.js. */
  const pulseOf = ({ pulse, offset }) => (offset === 'uniform' ? pulses.offCentre : pulses[pulse]);

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

  /** Return the least E[d^3] / d_m for unit std and where it lies: below it no diameter matches. */
  function turning() {
    const value = (mean) => new Sizes(mean, 1).moment(3) / mean;
    let [low, high] = [0.5, 2];
    for (let i = 0; i < 80; i += 1) {
      const third = (high - low) / 3;
      if (value(low + third) < value(high - third)) high -= third;
      else low += third;
    }
    return { mean: low, value: value(low) };
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

  function matchedDiameter(wanted, std) {
    const least = turning();
    if (least.value * std * std > wanted) return NaN;
    let [low, high] = [least.mean * std, Math.sqrt(wanted)];
    for (let i = 0; i < 100; i += 1) {
      const middle = 0.5 * (low + high);
      if (new Sizes(middle, std).moment(3) / middle > wanted) high = middle;
      else low = middle;
    }
    return 0.5 * (low + high);
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

  rub.model = { pulses, Sizes, calibratedDiameter, contact, pulseOf };
})();
