/* Lessons 4 and 5: who is alive, and the sum of all areas. */
const { lessons } = rub;
const { contact } = lessons;
const { say, share, um, um2 } = lessons.words;
const drag = rub.drag.number;

/* Var[d] = E[d] (E[d^2]/E[d] - E[d]). */
const bornStd = (f) => Math.sqrt(f.diameterMean * (f.lengthBiasedMean - f.diameterMean));

lessons.add({
  id: 'alive',
  controls: ['meanCount', 'spread'],
  title: 'Who is alive?',
  question: `Every junction that is born is measured: the diameters average some value. Now the sliding is stopped at
    a place chosen blindly, and only the junctions in contact there are measured. How does their average compare?`,
  prediction: {
    options: [
      { id: 'same', text: `it is the same: they are the same junctions` },
      { id: 'larger', text: `it is larger`, right: true },
      { id: 'smaller', text: `it is smaller` },
      { id: 'depends', text: `larger or smaller, depending on the place` },
    ],
  },
  evidence: {
    run: 0,
    row: 1,
    asks: `How did the mean diameter in contact compare with that at birth?`,
    says: ({ 0: [born, live] }) => (live > 1.03 * born ? 'larger' : live < born / 1.03 ? 'smaller' : 'same'),
  },
  needs: { births: 'poisson' },
  experiment: {
    pace: 1, // lives a second
    lives: 30,
    text: `Very unequal junctions, so that the difference can be seen.`,
    runs: [{ label: 'Run with unequal sizes', set: contact({ spread: 2 }), show: 'sizes' }],
    watch: [
      `Pause a few times and look at the stage: how many small circles are in contact, how many large ones?`,
      `The picture of who is alive: diameters found in contact, their law, and dashed the law of those born.`,
      `The table below keeps both averages: of all that were born, and of those found in contact.`,
      `It also notes how much of its life each junction found in contact has behind it, and how many others a newborn
        finds.`,
    ],
    table: [
      { label: 'mean diameter of those born', unit: 'um', value: (v) => v.diameterMean },
      { label: 'mean diameter of those in contact', unit: 'um', value: (v) => v.lengthBiasedMean },
      { label: 'share of its life a junction in contact has behind it', seen: (s) => s.ageMean, exact: () => 1 / 2 },
      { label: 'others in contact at a birth', seen: (s) => s.metMean, exact: (f) => f.countMean },
    ],
  },
  law: (f) => `
    <p>A junction of diameter <var>d</var> is in contact over a path of 2<var>d</var>: at a random
      place you meet it with a chance in proportion to <var>d</var>. Those found alive therefore have the density
      <var>d</var> <var>f</var>(<var>d</var>)/E[<var>d</var>], where <var>f</var> is that of those born:</p>
    <p class="formula">mean of those in contact = E[<var>d</var>²]/E[<var>d</var>] = E[<var>d</var>] +
      Var[<var>d</var>]/E[<var>d</var>] = ${um(f.lengthBiasedMean)}</p>
    <p>against ${um(f.diameterMean)} at birth. This is the <strong>inspection paradox</strong>; only equal sizes
      escape it. By the same token every place of a life is as likely to be met as every other: <strong>ages are
      uniform</strong>, and on average half of the life is over.</p>
    <p>A birth at random knows nothing of what it finds, so it finds what a blindly chosen place shows:
      ${say(f.countMean)} others on average (<strong>births see time averages</strong>). Births that keep their
      distance do not.</p>`,
  checks: [
    {
      id: 'biased',
      unit: 'um',
      prompt: (
        f,
      ) => `Another surface makes junctions of the same mean diameter, ${um(f.diameterMean)}, with a standard
        deviation of ${um(2 * bornStd(f))}, twice that of the stage. What is the mean diameter of those in contact
        there?`,
      expected: (f) => f.diameterMean + (2 * bornStd(f)) ** 2 / f.diameterMean,
      tolerance: 0.01,
      hints: [
        [(f) => f.diameterMean, `That is the mean of those born.`],
        [
          (f) => f.lengthBiasedMean,
          `That is the surface on the stage. Here the standard deviation is twice as large, the variance four times.`,
        ],
        [
          (f) => f.diameterMean + (2 * bornStd(f) ** 2) / f.diameterMean,
          `Twice the standard deviation is four times the variance.`,
        ],
        [(f) => Math.hypot(f.diameterMean, 2 * bornStd(f)), `That is √E[<var>d</var>²], the root mean square.`],
        [
          (f) => f.diameterMean + 2 * bornStd(f),
          `A whole standard deviation is too much: add Var[<var>d</var>]/E[<var>d</var>].`,
        ],
      ],
      hint: `E[<var>d</var>] + Var[<var>d</var>]/E[<var>d</var>], and the variance is the square of the standard
        deviation.`,
    },
    {
      id: 'newborn',
      prompt: (f) =>
        `Births at random, ${say(f.countMean)} alive on average. How many others does a newborn junction find in
          contact, on average?`,
      options: [
        [
          (f) => `${say(f.countMean - 1)}: one fewer, for itself`,
          `A birth at random has no ties to those already there. Would fewer of them make a birth more likely?`,
        ],
        [(f) => say(f.countMean)],
        [
          (f) => `${say(f.countMean + 1)}: births come in clusters`,
          `The clusters are chance too: a birth makes no other birth more likely.`,
        ],
        [`that depends on the sizes`, `The count is Poisson for sizes of any law, and a birth knows nothing of it.`],
      ],
    },
  ],
});

lessons.add({
  id: 'sum',
  controls: ['meanArea', 'meanCount', 'spread', 'pulse'],
  title: 'The sum',
  question: `The real contact area is the sum of the areas of all live junctions. With 20 equal ones alive on average,
    by how much does the sum typically stray from its mean, as a share of the mean?`,
  prediction: {
    options: [
      { id: 'five', value: 0.05, text: `about 5 %` },
      { id: 'twelve', value: 0.12, text: `about 12 %` },
      { id: 'quarter', value: 0.27, text: `about 27 %`, right: true },
      { id: 'half', value: 0.5, text: `about 50 %` },
    ],
  },
  evidence: { run: 1, row: 2, asks: `“20 junctions”: by how much did the area stray, as a share of its mean?` },
  needs: { births: 'poisson', pulse: 'lens', spread: 0 },
  experiment: {
    sound: 'force',
    pace: 2, // lives a second
    lives: 40,
    text: `The same mean area, made of 2, of 20 and of 100 junctions. Now it is ${drag('meanCount')} of
      ${drag('diameter')}: drag a number to change it.`,
    runs: [
      { label: '2 junctions', set: contact({ meanCount: 2 }), show: 'beside histogram' },
      { label: '20 junctions', set: contact({ meanCount: 20 }), show: 'beside histogram' },
      { label: '100 junctions', set: contact({ meanCount: 100 }), show: 'beside histogram' },
    ],
    watch: [
      `With 2 junctions the histogram leans to one side. For some of the way there is no contact at all: the thick line
        at area 0 is the exact share.`,
      `With 20 and 100 it becomes narrow and symmetric: the bell curve arrives.`,
      `All runs stand beside each other on equal axes: the same mean, another swing.`,
    ],
    table: [
      { label: 'mean area', unit: 'um^2', value: (v) => v.areaMean },
      { label: 'standard deviation of the area', unit: 'um^2', value: (v) => v.areaStd },
      { label: 'standard deviation over mean', value: (v) => v.areaStd / v.areaMean },
      { label: 'skewness', value: (v) => v.skewness },
    ],
  },
  law: (f) => `
    <p>Cut the path behind a place into steps d<var>s</var>. Each step, by itself, has had a birth with chance λ
      d<var>s</var>; if so, it adds <var>A</var>(<var>s</var>) here and now. Its mean is λ <var>A</var> d<var>s</var>,
      its variance λ <var>A</var>² d<var>s</var>, and since the steps are independent both add up (<strong>Campbell's
      theorem</strong>):</p>
    <p class="formula">mean = λ ∫ <var>A</var> d<var>s</var> = λ (2/3) <var>d</var>³, variance = λ ∫ <var>A</var>²
      d<var>s</var> = λ (π/3 − 32/45) <var>d</var>⁵</p>
    <p>With λ = <var>N</var>/(2<var>d</var>) the diameter drops out of the ratio:</p>
    <p class="formula">standard deviation / mean = (3/2) √((2π/3 − 64/45)/<var>N</var>) =
      ${lessons.swing().toFixed(4)}/√<var>N</var></p>
    <p>which is ${share(f.areaStd / f.areaMean)} for the ${say(f.countMean)} junctions on the stage: ${um2(f.areaStd)}
      of ${um2(f.areaMean)}. It exceeds 1/√<var>N</var>, the swing of the count, because the areas differ from
      junction to junction as well. The skewness, λ ∫ <var>A</var>³ d<var>s</var> over variance to the power 3/2,
      falls as 1/√<var>N</var> too: what is left is the bell curve of many small independent parts (Campbell 1909;
      Rice 1944).</p>`,
  checks: [
    {
      id: 'ratio',
      prompt: (f) =>
        `Turn the mean count from ${say(f.countMean)} to ${say(4 * f.countMean)}, at the same mean area. What will the
          standard deviation be, as a share of the mean?`,
      expected: (f) => f.areaStd / f.areaMean / 2,
      tolerance: 0.02,
      hints: [
        [(f) => f.areaStd / f.areaMean / 4, `Four times as many junctions make a quarter of the <em>variance</em>.`],
        [
          (f) => 1 / Math.sqrt(4 * f.countMean),
          `That is the swing of the count alone. The areas differ from junction to junction too.`,
        ],
        [(f) => f.areaStd / f.areaMean, `That is the ratio before the change.`],
      ],
      hint: `It is ${lessons.swing().toFixed(4)}/√<var>N</var>; give it as a share, such as 0.5 or 50 %.`,
    },
    {
      id: 'bell',
      prompt: `Why does the histogram become a bell curve as the number grows?`,
      options: [
        [`because the diameters follow a bell curve`, `In this experiment all diameters are equal.`],
        [`because the area is a sum of many small independent parts`],
        [
          `because a life curve has the shape of a bell`,
          `Triangles do it too: choose another life among the controls.`,
        ],
        [`because births and deaths come to balance`, `They balance with 2 junctions as well, and there it leans.`],
      ],
    },
  ],
});
