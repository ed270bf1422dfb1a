/* Lives of junctions: areas in um^2 at a distance since birth, and what theory says of them, in tables of the package. */
const { gauss, pieces, polynomial } = rub.numbers;
const { edges, lags, lives } = rub.tables;
const FAR = edges.at(-1);
const CELL = gauss(4);

/** Integral of the lens from its birth on, in um^3: of (acos x - x sqrt(1 - x^2)) / 2, mirrored after mid-life. */
function lensSum(sinceBirth, diameter) {
  const x = Math.min(1, Math.abs(diameter - sinceBirth) / diameter);
  const root = Math.sqrt((1 - x) * (1 + x));
  const half = 0.5 * (root - root ** 3 / 3 - x * Math.acos(x));
  return diameter ** 3 * (sinceBirth <= diameter ? half : 2 / 3 - half);
}

/** Integral of the triangle from its birth on, in um^3. */
function triangleSum(sinceBirth, diameter) {
  const u = Math.max(0, Math.min(sinceBirth, 2 * diameter - sinceBirth) / diameter);
  const half = (Math.PI / 8) * u * u;
  return diameter ** 3 * (sinceBirth <= diameter ? half : Math.PI / 4 - half);
}

/** Integral of the parabola from its birth on, in um^3. */
function parabolaSum(sinceBirth, diameter) {
  const s = Math.min(Math.max(0, sinceBirth), 2 * diameter);
  return (Math.PI / 4) * s * s * (diameter - s / 3);
}

const missedArea = rub.areaOf('lens');

/** Integral between two ages of the area of circles that miss each other's centre, in um^3, by a Gauss rule. */
function missedBetween(from, to, diameter, offset) {
  const middle = rub.halfLife(diameter, offset);
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

const life = (shape, sum) => ({ area: rub.areaOf(shape), sum, ...throughCentres(lives[shape]) });
const lens = life('lens', lensSum);
const pulses = {
  lens,
  triangle: life('triangle', triangleSum),
  parabola: { ...life('parabola', parabolaSum), shareBelow: (t) => 1 - Math.sqrt(1 - t ** 3) },
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

rub.model = { pulses, pulseOf };
