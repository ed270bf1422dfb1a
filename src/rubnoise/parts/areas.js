/* Lives of junctions, as pages of lessons and runs draw them: areas, and the lanes of life-lines. */
/** Areas of unit diameter whose centres are r < 1 apart: of two circles, of Rabinowicz's triangle, of two hills. */
const SHARED = {
  lens: (r) => 0.5 * (Math.acos(r) - r * Math.sqrt((1 - r) * (1 + r))),
  triangle: (r) => 0.25 * Math.PI * (1 - r),
  parabola: (r) => 0.25 * Math.PI * (1 - r) * (1 + r),
};

/** Return how far a junction slides from birth to mid-life: d, or sqrt(d^2 - b^2). */
const halfLife = (diameter, offset) => (offset ? Math.sqrt((diameter - offset) * (diameter + offset)) : diameter);

/** Return the area in um^2 of a shape, by distance since birth, diameter and lateral offset: d^2 L(r). */
function areaOf(shape) {
  const shared = SHARED[shape];
  return (sinceBirth, diameter, offset = 0) => {
    const along = sinceBirth - halfLife(diameter, offset);
    const apart = Math.sqrt(along * along + offset * offset) / diameter;
    return apart < 1 ? diameter * diameter * shared(apart) : 0;
  };
}

/** Return the lowest lane that is free at a birth, and keep it until a death; ends are those of the lanes so far. */
function laneOf(ends, birth, death) {
  const free = ends.findIndex((end) => end <= birth);
  const lane = free < 0 ? ends.length : free;
  ends[lane] = death;
  return lane;
}

Object.assign(rub, { halfLife, areaOf, laneOf });
