'use strict';
/* Lives of junctions: areas in um^2 at a distance since birth, and what theory says of them, in tables of the package. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { gauss, pieces, polynomial } = rub.numbers;
  const { rising, edges, lags, lives } = rub.tables;
  const FAR = edges.at(-1);
  const CELL = gauss(4);
  const risingSum = rising.map((c, n) => c / (n + 2.5));

  /** Area of the lens: A = d^2 a(s/d), a(u) = (acos(1 - u) - (1 - u) sqrt(u (2 - u))) / 2 and its mirror image. */
  function lensArea(sinceBirth, diameter) {
    const u = Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter;
    return u > 0 ? diameter * diameter * u * Math.sqrt(u) * polynomial(rising, u) : 0;
  }

  /** Integral of the lens from its birth on, in um^3: d^3 times the antiderivative, mirrored after mid-life. */
  function lensSum(sinceBirth, diameter) {
    const u = Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter;
    const half = u > 0 ? u * u * Math.sqrt(u) * polynomial(risingSum, u) : 0;
    return diameter ** 3 * (sinceBirth <= diameter ? half : 2 / 3 - half);
  }

  /** Area of Rabinowicz's triangle: (pi/4) d (d - |d - s|). */
  function triangleArea(sinceBirth, diameter) {
    return Math.max(0, 0.25 * Math.PI * diameter * Math.min(sinceBirth, 2 * diameter - sinceBirth));
  }

  /** Integral of the triangle from its birth on, in um^3. */
  function triangleSum(sinceBirth, diameter) {
    const u = Math.max(0, Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter);
    const half = (Math.PI / 8) * u * u;
    return diameter ** 3 * (sinceBirth <= diameter ? half : Math.PI / 4 - half);
  }

  /** Area of the parabola, which rough surfaces have: (pi/4) s (2d - s). */
  function parabolaArea(sinceBirth, diameter) {
    return Math.max(0, 0.25 * Math.PI * sinceBirth * (2 * diameter - sinceBirth));
  }

  /** Integral of the parabola from its birth on, in um^3. */
  function parabolaSum(sinceBirth, diameter) {
    const s = Math.min(Math.max(0, sinceBirth), 2 * diameter);
    return (Math.PI / 4) * s * s * (diameter - s / 3);
  }

  /** Return how far a junction slides from birth to mid-life: d, or sqrt(d^2 - b^2). */
  const halfLife = (diameter, offset) => (offset ? Math.sqrt((diameter - offset) * (diameter + offset)) : diameter);

  /**
   * Area of two circles that miss each other's centre by a lateral offset b, uniform on (-d, d): d^2 L(r), r =
   * sqrt(x^2 + b^2)/d, that of a lens whose circles are as far apart.
   */
  function missedArea(sinceBirth, diameter, offset) {
    const life = 2 * halfLife(diameter, offset);
    const left = Math.min(sinceBirth, life - sinceBirth);
    if (!(left > 0)) return 0;
    const rest = (left * (life - left)) / diameter ** 2; // 1 - r^2
    return lensArea((diameter * rest) / (1 + Math.sqrt(Math.max(0, 1 - rest))), diameter);
  }

  /** Integral of that area between two ages, in um^3, by a Gauss rule on either side of mid-life. */
  function missedBetween(from, to, diameter, offset) {
    const middle = halfLife(diameter, offset);
    if (from < middle && middle < to) {
      return missedBetween(from, middle, diameter, offset) + missedBetween(middle, to, diameter, offset);
    }
    let sum = 0;
    for (let i = 0; i < CELL.x.length; i += 1) {
      sum += CELL.w[i] * missedArea(from + 0.5 * (to - from) * (1 + CELL.x[i]), diameter, offset);
    }
    return 0.5 * (to - from) * sum;
  }

  /** Return a spectrum that a table holds, a function of z = k d >= 0, and its parts from z = 32 on. */
  function spectrumOf({ near, fall, root, level, swings }) {
    const before = pieces(edges, near);
    const parts = (z) => {
      const [x, scale] = [FAR / z, z ** -fall];
      const values = swings.map((pair) => pair.map((c) => polynomial(c, x) * x ** root * scale));
      return [polynomial(level, x) * scale, ...values];
    };
    const value = (z) => {
      if (z < FAR) return before(z) * (1 + z * z) ** (-0.5 * fall);
      const [mean, ...waves] = parts(z);
      return waves.reduce((sum, [c, s], n) => sum + c * Math.cos((n + 1) * z) + s * Math.sin((n + 1) * z), mean);
    };
    return { value, parts };
  }

  /**
   * Return what theory says of a life of unit diameter. transform: a^(z) about mid-life; energy: its square, which d^6
   * times is |A^|^2; meanSquare: the same without its swing from z = 32 on; birth: real and imaginary part of what the
   * birth alone brings to a^(z) about the birth from there on, but for a turn.
   */
  function throughCentres({ overlap, ...table }) {
    const { value, parts } = spectrumOf(table);
    const meanSquare = (z) => {
      if (z < FAR) return value(z) ** 2;
      const [mean, [c, s]] = parts(z);
      return mean * mean + 0.5 * (c * c + s * s);
    };
    const birth = (z) => (z < FAR ? [0, 0] : [0.5 * parts(z)[1][0], -0.5 * parts(z)[1][1]]);
    const energy = (z) => value(z) ** 2;
    return { ...table, overlap: pieces(lags, overlap), transform: value, energy, meanSquare, birth };
  }

  /** Return the same, as far as it is known, of passes off the centre line: the mean of the energy over offsets. */
  function offCentre({ overlap, ...table }) {
    const { value, parts } = spectrumOf(table);
    const meanSquare = (z) => (z < FAR ? value(z) : parts(z)[0]);
    return { ...table, overlap: pieces(lags, overlap), energy: value, meanSquare };
  }

  const lens = { area: lensArea, sum: lensSum, ...throughCentres(lives.lens) };
  const pulses = {
    lens,
    triangle: { area: triangleArea, sum: triangleSum, ...throughCentres(lives.triangle) },
    parabola: {
      area: parabolaArea,
      sum: parabolaSum,
      shareBelow: (t) => 1 - Math.sqrt(1 - t ** 3),
      ...throughCentres(lives.parabola),
    },
    offCentre: {
      area: missedArea,
      between: missedBetween,
      centred: lens,
      /** P(area <= a) of a live junction of unit diameter from the age in half-lives at which a lens has it. */
      aliveShare: (age) => age * (2 - age),
      ...offCentre(lives.offCentre),
    },
  };

  /** Return the pulse of a world. */
  const pulseOf = ({ pulse, offset }) => (offset === 'uniform' ? pulses.offCentre : pulses[pulse]);

  rub.model = { pulses, pulseOf, halfLife };
})();
