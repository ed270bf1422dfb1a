/* The life of one junction: its area, its peak, and the contact there, as `rubnoise junctions` has them. */
"use strict";
(() => {
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

  /** What a row of free motion says: a touch, whose area no row knows from place to place. */
  const touch = (row) => {
    const { lives } = view;
    const [born, died] = [lives.birth_distance[row], lives.death_distance[row]];
    const middle = 0.5 * (Math.max(born, 0) + Math.min(died, data.distance));
    return {
      junction: lives.junction[row], state: lives.state[row], birth: born, death: died, length: died - born,
      birthTime: lives.birth_time[row], deathTime: lives.death_time[row],
      diameter: lives.diameter[row], maxArea: lives.max_area[row], maxOverlap: lives.max_overlap[row],
      strength: "shear_strength" in lives.units ? lives.shear_strength[row] : null,
      peak: middle,
      others: view.aliveAt(middle).filter((other) => other !== row).map((other) => lives.junction[other]),
    };
  };

  view.life = (row) => {
    const { lives } = view;
    if (data.flights) return touch(row);
    const at = (name) => (name in lives.units ? lives[name][row] : null);
    const [born, died, d, length] = ["birth_distance", "death_distance", "diameter", "life_distance"].map(at);
    const aside = at("lateral_offset");
    const half = aside === null ? d : Math.sqrt((d - aside) * (d + aside));
    const peakAge = Math.min(Math.max(Math.min(half, length), -born), data.distance - born);
    const atDeath = peakAge === length;
    const peak = atDeath ? died : born + peakAge;
    const peakArea = view.areaAtAge(row, peakAge);
    const strength = at("shear_strength");
    const beside = view.aliveAt(peak, atDeath).filter((other) => other !== row);
    let area = 0;
    let force = 0;
    for (const other of beside) {
      const one = view.areaAtAge(other, peak - lives.birth_distance[other]);
      area += one;
      if (strength !== null) force += lives.shear_strength[other] * one;
    }
    const own = strength === null ? null : strength * peakArea;
    const whole = peakArea + area;
    return {
      junction: at("junction"),
      birth: born, death: died, length, diameter: d,
      offset: aside,
      middle: length >= half ? born + half : null,
      birthTime: at("birth_time"),
      deathTime: at("death_time"),
      maxArea: at("max_area"),
      state: at("state"),
      strength, peak, peakArea,
      peakForce: own,
      realContactArea: whole,
      frictionForce: own === null ? null : own + force,
      areaShare: whole ? peakArea / whole : 0,
      others: beside.map((other) => lives.junction[other]),
    };
  };

  view.stateNames = (state) => {
    const names = Object.entries(view.data.states).filter(([, bit]) => state & bit).map(([name]) => name);
    return names.length ? names : ["complete"];
  };
})();
