/* The life of one junction: its area, its peak, and the contact there, as `rubnoise junctions` has them. */
const { data } = view;
const areaOf = rub.areaOf(data.pulse.replace("off-centre ", ""));
const rows = view.livesOf(data.junctions, areaOf, data.twoWay ? null : data.speed);
view.lives = rows;
const { birth_distance: birth, death_distance: death } = rows;
let longest = 0;
for (let row = 0; row < birth.length; row += 1) longest = Math.max(longest, death[row] - birth[row]);

const offset = (row) => ("lateral_offset" in view.lives ? view.lives.lateral_offset[row] : 0);

/** The area in um^2 of a row at a sliding distance after its birth, whether it is alive or not. */
view.areaAtAge = (row, age) => areaOf(age, view.lives.diameter[row], offset(row));

/** The first row that can be alive at a distance, as rows are in order of birth. */
view.firstAlive = (s) => rub.firstAtLeast(birth, s - longest);

/** The rows that live anywhere between two distances. */
view.livesBetween = (from, to) => {
  const found = [];
  for (let row = view.firstAlive(from); row < birth.length && birth[row] <= to; row += 1) if (death[row] >= from) found.push(row);
  return found;
};

/** The rows alive at a distance: birth <= s < death, or just before it, birth < s <= death. */
view.aliveAt = (s, justBefore = false) => {
  const found = [];
  for (let row = view.firstAlive(s); row < birth.length && birth[row] <= s; row += 1) {
    if (justBefore ? birth[row] < s && s <= death[row] : birth[row] <= s && s < death[row]) found.push(row);
  }
  return found;
};

const besides = (row, s, justBefore = false) => view.aliveAt(s, justBefore).filter((other) => other !== row);

/** The largest of a life, and the contact there. */
const peakOf = (row, { birth: born, death: died, length, diameter, offset: aside, strength }) => {
  const { lives } = view;
  const half = rub.halfLife(diameter, aside ?? 0);
  const peakAge = Math.min(Math.max(Math.min(half, length), -born), data.distance - born);
  const atDeath = peakAge === length;
  const peak = atDeath ? died : born + peakAge;
  const beside = besides(row, peak, atDeath);
  const sum = (of) => [row, ...beside].reduce((total, one) => total + of(one) * view.areaAtAge(one, peak - birth[one]), 0);
  const peakArea = view.areaAtAge(row, peakAge);
  const whole = sum(() => 1);
  const forces = strength === null ? {} : { peakForce: strength * peakArea, frictionForce: sum((one) => lives.shear_strength[one]) };
  return {
    peak, peakArea, realContactArea: whole, areaShare: whole ? peakArea / whole : 0, peakForce: null, frictionForce: null, ...forces,
    middle: length >= half ? born + half : null, others: beside.map((other) => lives.junction[other]),
  };
};

/** What a row says. Of a touch of free motion no row knows the area from place to place. */
view.life = (row) => {
  const { lives } = view;
  const at = (name) => (name in lives.units ? lives[name][row] : null);
  const life = {
    junction: at("junction"), state: at("state"), birth: birth[row], death: death[row], length: at("life_distance"),
    birthTime: at("birth_time"), deathTime: at("death_time"), diameter: at("diameter"), offset: at("lateral_offset"),
    maxArea: at("max_area"), maxOverlap: at("max_overlap"), strength: at("shear_strength"),
  };
  if (!data.flights) return { ...life, ...peakOf(row, life) };
  const middle = 0.5 * (Math.max(birth[row], 0) + Math.min(death[row], data.distance));
  return { ...life, others: besides(row, middle).map((other) => lives.junction[other]) };
};

view.stateNames = (state) => {
  const names = Object.entries(view.data.states).filter(([, bit]) => state & bit).map(([name]) => name);
  return names.length ? names : ["complete"];
};
