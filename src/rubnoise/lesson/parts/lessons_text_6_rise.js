/* Lesson 10: a slider that rests on its load. */
const { lessons, load } = rub;
const { contact } = lessons;
const { say, share, um } = lessons.words;
/* The contact of Fig. 5 as two rough surfaces make it, and the paper's slider. */
const ROUGH = contact({ pulse: 'parabola', sizes: 'rayleigh' });
const { SLIDER } = lessons;
const MANY = 50;
const riseOf = (count) => load.SCALE * Math.sqrt(2 / count);

lessons.add({
  id: 'rise',
  controls: ['support', 'speed', 'meanCount'],
  title: 'Let it rise',
  question: `So far both surfaces slid at a fixed gap, and the force varied with the area. A real slider rests on its
    load: it rises where many junctions meet, and sinks where few do. One switch lets it. What becomes of the variation
    of the friction force?`,
  prediction: {
    options: [
      { id: 'louder', value: 1, text: `larger: the slider bounces` },
      { id: 'same', value: 0.32, text: `the same: the junctions are the same` },
      { id: 'half', value: 0.16, text: `about half` },
      { id: 'quiet', value: 0.01, text: `next to nothing: the force goes quiet`, right: true },
    ],
  },
  evidence: { run: 1, row: 0, asks: `“Constant load”: how large was the spread of the force over its mean?` },
  needs: { births: 'poisson', pulse: 'parabola' },
  experiment: {
    sound: 'velocity',
    pace: 7, // lives a second
    lives: 60,
    text: `The contact of Fig. 5, of hills as rough surfaces have them: first at constant gap, then under a load of
      0.2 N. Heights vary by ${um(load.SCALE)}.`,
    runs: [
      { label: 'Constant gap', set: { ...ROUGH, ...SLIDER }, show: 'force slider' },
      { label: 'Constant load', set: { ...ROUGH, ...SLIDER, support: 'load' }, show: 'force slider' },
    ],
    watch: [
      `The trace of the force, on one scale in both runs. What is left of it?`,
      `The slider's displacement: what drives it now?`,
      `Turn the speed up to 1000 mm/s with the load on. What comes back, and what does not?`,
    ],
    table: [
      { label: 'spread of the force over its mean', value: (v) => v.forceStd / v.forceMean },
      { label: 'standard deviation of the displacement', unit: 'um', value: (v) => v.displacementStd },
      { label: 'standard deviation of the separation', unit: 'um', value: (v) => v.separationStd },
    ],
  },
  law: (f, world) => `
    <p>Let ε be the area over its mean, less 1, that the surfaces would have at constant gap. A rise by <var>z</var>
      takes away the share <var>z</var>/<var>s</var>₀ of it, where <var>s</var>₀ = ${um(load.SCALE)} is how heights
      vary. Area times hardness is what the junctions bear, <var>P</var>:</p>
    <p class="formula"><var>P</var>/<var>W</var> = 1 + ε − <var>z</var>/<var>s</var>₀, <var>m</var><var>z</var>″ +
      <var>c</var><var>z</var>′ = <var>P</var> − <var>W</var></p>
    <p>This is one more oscillator, with the contact resonance ω<sub>c</sub> = √(<var>W</var>/(<var>m</var>
      <var>s</var>₀)), here ${say(load.of(world).resonance / (2 * Math.PI))} Hz. Much slower changes of ε are followed:
      <var>z</var> = <var>s</var>₀ε, and <var>P</var> stays <var>W</var>. What is left falls as
      (ω/ω<sub>c</sub>)²,</p>
    <p class="formula"><var>P</var>/<var>W</var> − 1 = ε (−ω² + 2iζω<sub>c</sub>ω)/(ω<sub>c</sub>² − ω² +
      2iζω<sub>c</sub>ω)</p>
    <p>Now the force spreads by ${share(f.forceStd / f.forceMean)} of its mean and the separation by
      ${um(f.separationStd)}; slow sliding would make that <var>s</var>₀√(2/<var>N</var>) =
      ${um(riseOf(f.countMean))}. Changes far above ω<sub>c</sub> find the slider too sluggish: the gap stands, and the
      force is that of all lessons before. The motion along the surface is not: at every speed the mean load stays
      <var>W</var>, so slow changes stay away, and a slider slower than ω<sub>c</sub> stays quiet. The paper is the
      limit of fast sliding with a slider whose own frequency is far above ω<sub>c</sub>, too.</p>`,
  checks: [
    {
      id: 'rise',
      unit: 'um',
      prompt: `Slow sliding under a load, ${MANY} junctions on average, heights that vary by ${um(load.SCALE)}: how
        far does the slider typically rise and sink (its standard deviation)?`,
      expected: () => riseOf(MANY),
      tolerance: 0.02,
      hints: [
        [() => load.SCALE / Math.sqrt(MANY), `That is the swing of the count. The areas differ, too: 2/<var>N</var>.`],
        [() => (load.SCALE * 2) / MANY, `That is the variance of ε times <var>s</var>₀. Take the root first.`],
        [() => load.SCALE, `That would be a swing of the area by all of itself.`],
      ],
      hint: `<var>z</var> = <var>s</var>₀ε, and the standard deviation of ε is √(2/<var>N</var>).`,
    },
    {
      id: 'gap',
      prompt: `When is a constant gap a fair assumption for the force?`,
      options: [
        [`when sliding is slow: there is time to follow`, `What is followed is taken away from the force.`],
        [`when the contact changes faster than the slider can rise`],
        [`when junctions are strong`, `Strength makes the whole force larger, quiet or not.`],
        [`never`, `Turn the speed up and compare the force with that at constant gap.`],
      ],
    },
  ],
});
