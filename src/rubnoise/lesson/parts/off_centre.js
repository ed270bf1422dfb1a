'use strict';
/* Junctions whose two circles miss each other's centre by a lateral offset b, uniform on (-d, d). Averages over offsets
 * are integrals over the disc in which one centre may pass the other. Source: docs/theory.md.
 */
(() => {
  const rub = (globalThis.rub ??= {});
  const { chebyshev, evenly, gauss, panels, piecewise } = rub.numbers;
  const { lens } = rub.model.pulses;
  const { hankel } = rub.model;
  const FAR = 32;
  const SMALL = 16; // of an argument of J_1 below which its expansion for large ones does not do
  const STEPS = 64; // of a trapezium rule over half a turn, exact for so small arguments
  const CELL = gauss(4);
  const once = (f) => {
    let known = null;
    return (...given) => (known ??= f())(...given);
  };

  /** Return how far a junction slides from birth to mid-life: d, or sqrt(d^2 - b^2). */
  const halfLife = (diameter, offset) => (offset ? Math.sqrt((diameter - offset) * (diameter + offset)) : diameter);

  /** Area d^2 L(r), r = sqrt(x^2 + b^2)/d: that of a lens whose circles are as far apart. */
  function area(sinceBirth, diameter, offset) {
    const life = 2 * halfLife(diameter, offset);
    const left = Math.min(sinceBirth, life - sinceBirth);
    if (!(left > 0)) return 0;
    const rest = (left * (life - left)) / diameter ** 2; // 1 - r^2
    return lens.area((diameter * rest) / (1 + Math.sqrt(Math.max(0, 1 - rest))), diameter);
  }

  /** Integral of the area between two ages, in um^3, by a Gauss rule on either side of mid-life. */
  function between(from, to, diameter, offset) {
    const middle = halfLife(diameter, offset);
    if (from < middle && middle < to) {
      return between(from, middle, diameter, offset) + between(middle, to, diameter, offset);
    }
    let sum = 0;
    for (let i = 0; i < CELL.x.length; i += 1) {
      sum += CELL.w[i] * area(from + 0.5 * (to - from) * (1 + CELL.x[i]), diameter, offset);
    }
    return 0.5 * (to - from) * sum;
  }

  const quarterTurn = panels([0, Math.PI / 2], 32);

  /** Return c_n = pi int_0^1 r L(r)^n dr, with r = cos y: the mean over offsets of int A^n ds is c_n d^(2n+1). */
  function lifeIntegral(power) {
    const term = (y) => Math.sin(y) * Math.cos(y) * (0.5 * (y - Math.sin(y) * Math.cos(y))) ** power;
    return Math.PI * quarterTurn.nodes.reduce((sum, y, i) => sum + quarterTurn.weights[i] * term(y), 0);
  }

  /** Return J_1 by Bessel's integral, for small arguments. */
  function besselIntegral(y) {
    let sum = 0;
    for (let i = 0; i < STEPS; i += 1) {
      const turn = ((i + 0.5) * Math.PI) / STEPS;
      sum += Math.cos(turn - y * Math.sin(turn));
    }
    return sum / STEPS;
  }

  const smallBessel = once(() => piecewise(besselIntegral, [0, 0.5 * SMALL, SMALL], 30));

  function bessel(y) {
    if (y < SMALL) return smallBessel(y);
    const [even, odd] = hankel(y);
    const phase = y - 0.75 * Math.PI;
    return Math.sqrt(2 / (Math.PI * y)) * (even * Math.cos(phase) - odd * Math.sin(phase));
  }

  /** Return F(q)^2 = (pi J_1(q/2)/q)^4, pi^4/256 at 0. */
  const fourthPower = (q) => (q > 1e-8 ? ((Math.PI * bessel(0.5 * q)) / q) ** 4 : (Math.PI / 4) ** 4);

  const theta = panels([0, Math.PI / 4, Math.PI / 2], 16);

  /**
   * Return (pi^3/2) (3/8) int_low^inf |H_1(q/2)|^4 / q^4 dp, q^2 = z^2 + p^2: what the energy has without its swing,
   * with p = low + z tan(turn).
   */
  function level(z, low = 0) {
    let sum = 0;
    theta.nodes.forEach((turn, i) => {
      const q = Math.hypot(z, low + z * Math.tan(turn));
      const [even, odd] = hankel(0.5 * q);
      const square = ((4 / (Math.PI * q)) * (even * even + odd * odd)) ** 2;
      sum += ((theta.weights[i] * square) / q ** 4) * (z / Math.cos(turn) ** 2);
    });
    return 0.1875 * Math.PI ** 3 * sum;
  }

  /** Return the mean of |a^|^2 over offsets, (1/2 pi) int_0^inf F(sqrt(z^2 + p^2))^2 dp, by quadrature. */
  function byQuadrature(z) {
    const reach = 256;
    const { nodes, weights } = panels(evenly(0, reach, reach / 4), 12);
    let sum = 0;
    for (let i = 0; i < nodes.length; i += 1) sum += weights[i] * fourthPower(Math.hypot(z, nodes[i]));
    return sum / (2 * Math.PI) + level(Math.max(z, 1), reach);
  }

  const scale = (z) => (1 + z * z) ** -2.5;
  const near = once(() => piecewise((z) => byQuadrature(z) / scale(z), [0, 8, 16, 24, FAR + 1e-9], 28));

  /* Complex numbers are pairs, real and imaginary part. */
  const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
  const power = (a, n) => (n === 1 ? a : times(a, power(a, n - 1)));
  const inverse = ([a, b]) => [a / (a * a + b * b), -b / (a * a + b * b)];
  function root([a, b]) {
    const size = Math.hypot(a, b);
    return [Math.sqrt(0.5 * (size + a)), Math.sign(b || 1) * Math.sqrt(0.5 * (size - a))];
  }

  /** Return exp(-i y) H^(1)_1(y), or with sign -1 exp(i y) H^(2)_1(y), for complex y, |y| >= 16 (DLMF 10.17.5). */
  function hankelAt(y, sign) {
    const turned = times(inverse(y), [0, sign]);
    let term = [1, 0];
    const sum = [1, 0];
    for (let k = 1; k <= 14; k += 1) {
      const factor = (4 - (2 * k - 1) ** 2) / (8 * k);
      term = times(term, turned).map((part) => part * factor);
      sum[0] += term[0];
      sum[1] += term[1];
    }
    const size = root(inverse(y.map((part) => 0.5 * Math.PI * part)));
    return times(times(size, [-Math.SQRT1_2, -sign * Math.SQRT1_2]), sum);
  }

  const descent = panels([0, 2, 6], 24);

  /**
   * Return what the energy has of exp(i n z), n = 1 or 2, along q = z + i s, where the Hankel functions decay, with
   * s = t^2/n. J_1^4 = (6 |H|^4 + 8 Re(H^3 H*) + 2 Re(H^4)) / 16.
   */
  function swing(z, n) {
    const sum = [0, 0];
    descent.nodes.forEach((t, i) => {
      const s = (t * t) / n;
      const q = [z, s];
      const forward = hankelAt([0.5 * z, 0.5 * s], 1);
      const fourth = n === 2 ? power(forward, 4) : times(power(forward, 3), hankelAt([0.5 * z, 0.5 * s], -1));
      const along = inverse(root([-n * s, 2 * n * z]));
      const whole = times(times(times(fourth, inverse(power(q, 3))), along), [0, 2]);
      const weight = descent.weights[i] * Math.exp(-t * t);
      sum[0] += weight * whole[0];
      sum[1] += weight * whole[1];
    });
    return sum.map((part) => 0.5 * Math.PI ** 3 * (n === 2 ? 0.125 : 0.5) * part);
  }

  /* All of this goes as a power of z times what polynomials in 1/z follow. */
  const follow = (f, fall) => {
    const table = once(() => chebyshev((x) => f(FAR / x) * (FAR / x) ** fall, 0, 1, 12));
    return (z) => table(FAR / z) / z ** fall;
  };
  const farLevel = follow(level, 5);
  const farSwings = [1, 2].map((n) => [0, 1].map((part) => follow((z) => swing(z, n)[part], 5.5)));

  /** Return the mean over offsets of |a^(z; b)|^2, z = k d >= 0: |A^(k)|^2 is d^6 times it. */
  function energy(z) {
    if (z < FAR) return near(z) * scale(z);
    return farSwings.reduce(
      (sum, [real, imaginary], i) => sum + real(z) * Math.cos((i + 1) * z) - imaginary(z) * Math.sin((i + 1) * z),
      farLevel(z),
    );
  }

  /** Return the same without its swing, from z = 32 on. */
  const meanSquare = (z) => (z < FAR ? energy(z) : farLevel(z));

  const TURNS = [0, 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1, 1.01, 1.05, 1.2, 1.5, 1.8, 1.95, 2];

  /** Return the mean over offsets of int a(s) a(s + t) ds, cut where either pass is closest. */
  function overlapAt(t) {
    const widest = Math.sqrt(Math.max(0, 1 - 0.25 * t * t));
    const offsets = panels([0, 0.02 * widest, 0.15 * widest, widest], 12, true);
    return offsets.nodes.reduce((sum, b, i) => sum + offsets.weights[i] * shared(t, b), 0);
  }

  function shared(t, b) {
    const half = halfLife(1, b);
    const last = half - t;
    if (!(last > -0.5 * t)) return 0;
    const cuts = rub.numbers.ordered([-0.5 * t, Math.min(last, Math.max(-0.5 * t, 0)), last]);
    if (cuts.length < 2) return 0;
    const { nodes, weights } = panels(cuts, 20, true);
    let sum = 0;
    for (let i = 0; i < nodes.length; i += 1) {
      sum += weights[i] * area(nodes[i] + half, 1, b) * area(nodes[i] + t + half, 1, b);
    }
    return 2 * sum;
  }

  const overlap = once(() => piecewise(overlapAt, TURNS, 14));

  /** Return P(area <= a) of a live junction of unit diameter from the age in half-lives at which a lens has it. */
  const aliveShare = (age) => age * (2 - age);

  rub.model.pulses.offCentre = {
    area,
    between,
    lifeIntegral,
    lifeMean: Math.PI / 16,
    meanLife: Math.PI / 2,
    tail: [0.5625 * Math.PI ** 2, 5],
    energy,
    meanSquare,
    overlap,
    centred: lens,
    aliveShare,
  };
  Object.assign(rub.model, { halfLife });
})();
