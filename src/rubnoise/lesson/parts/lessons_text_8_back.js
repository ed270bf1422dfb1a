/* Lesson 12: the slider of lesson 7 pushes back. */
const { lessons } = rub;
const { say, um } = lessons.words;
const BEARS = 60000; // uN, of the question about a stick
const PULLS = 45000;

/** Return how long a slider is stuck that is pulled with one force where the contact bears another, in s. */
const stuckFor = (bears, pulls, world) => (bears - pulls) / (world.stiffness * world.speed);

/* Nothing is exact about a slider that pushes back. */
const atConstantSpeed = (value) => (f, world) => (world.coupling === 'two-way' ? NaN : value(f));

lessons.add({
  id: 'back',
  controls: ['coupling', 'speed', 'damping'],
  title: 'It pushes back',
  question: `So far the surfaces slid at <var>V</var>, whatever the slider did. But they slide at <var>V</var> −
    <var>x</var>′: a slider that moves with the surface meets the same junctions later. At 1 mm/s, what does the
    vibration of the slider of lesson 7 become when it can push back?`,
  prediction: {
    options: [
      { id: 'same', text: `much the same: the junctions are the same, only their times shift a little` },
      { id: 'larger', text: `larger and larger: every swing meets more junctions than the one before` },
      { id: 'clipped', text: `smaller: it rides on the surface for most of the time, and jumps now and then`, right: true },
      { id: 'none', text: `none: it comes to rest where the spring carries the mean force` },
    ],
  },
  evidence: {
    run: 1,
    row: 0,
    asks: `What did the vibration become when the slider could push back?`,
    says: ({ 0: [before], 1: [after] }) =>
      after > 1.4 * before ? 'larger' : after > 0.7 * before ? 'same' : after > 0.02 * before ? 'clipped' : 'none',
  },
  needs: { births: 'poisson' },
  experiment: {
    pace: 6, // lives a second
    text: `The contact and the slider of Fig. 5 once more, the same junctions at the same places. Only the coupling is
      new; it stands among the controls too.`,
    runs: [
      { label: 'The drive’s speed is constant', set: lessons.fig5, show: 'slider' },
      { label: 'The slider pushes back', set: { ...lessons.fig5, coupling: 'two-way' }, show: 'slider' },
    ],
    watch: [
      `Where the traces are shaded the slider moves at the speed of the drive, and the stage stands still. What ends
        that?`,
      `Its velocity beside the dotted line, the speed of the drive: how far above does it come, and how far below?`,
      `Turn the coupling there and back among the controls, and compare the spread of the displacement.`,
    ],
    table: [
      {
        label: 'standard deviation of the displacement',
        unit: 'um',
        seen: (s) => s.displacementStd,
        exact: atConstantSpeed((f) => f.displacementStd),
      },
      {
        label: 'velocity’s standard deviation over sliding speed',
        seen: (s, f, world) => s.velocityStd / world.speed,
        exact: atConstantSpeed((f) => f.oneWay),
      },
      {
        label: 'share of the time at the drive’s speed',
        seen: (s) => s.stuckShare,
        exact: atConstantSpeed(() => 0),
      },
    ],
  },
  law: (f, world) => `
    <p>What the contact can bear, ψ<var>A</var>(<var>s</var>), belongs to the place <var>s</var>, not to the time.
      While the surfaces slide, friction is as large as that and drags the slider along,</p>
    <p class="formula"><var>m</var><var>x</var>″ + <var>c</var><var>x</var>′ + <var>k</var><var>x</var> =
      ψ<var>A</var>(<var>s</var>), <var>s</var> = <var>V</var><var>t</var> − <var>x</var></p>
    <p>but only until the slider is as fast as the surface. Were it faster, friction would turn round and brake it. So it
      <strong>sticks</strong>: the same junctions hold it, <var>x</var> grows at <var>V</var>, friction is what spring
      and damper ask for, and it lasts until they ask for more than the contact can bear:</p>
    <p class="formula">stuck while |<var>k</var><var>x</var> + <var>c</var><var>V</var>| ≤
      ψ<var>A</var>(<var>s</var>), for a time (ψ<var>A</var> − <var>k</var><var>x</var> −
      <var>c</var><var>V</var>)/(<var>k</var><var>V</var>)</p>
    <p>Then it <strong>slips</strong>: the spring throws it back over many junctions, and friction fetches it again. No
      swing builds upon the last one, for each begins at rest on the surface, near <var>x</var> =
      ψ<var>A</var>/<var>k</var>. So the displacement spreads about as the force over the stiffness does,
      ${um(f.forceStd / world.stiffness)}, not as resonance would have it, ${um(f.displacementStd)}. Faster than the
      surface it is only where the spring pushes it forward by more than the contact can bear, which takes very few
      junctions.</p>
    <p>The slider waits where the contact is large. So who looks at a random <em>time</em> finds more area than
      ${say(f.areaMean)} µm², the mean over the <em>distance</em>. And pushing back does not always calm: at 30 mm/s the
      vibration is larger with it than without. At 100 mm/s the coupling hardly matters: nothing sticks there.</p>`,
  checks: [
    {
      id: 'wait',
      unit: 's',
      prompt: (f, world) => `The slider has just stuck at a place where the contact can bear ${say(BEARS / 1000)} mN.
        Spring and damper pull with ${say(PULLS / 1000)} mN. The spring has ${say(world.stiffness)} N/m, the drive
        ${say(world.speed / 1000)} mm/s. For how long is it stuck, in s?`,
      expected: (f, world) => stuckFor(BEARS, PULLS, world),
      tolerance: 0.01,
      hints: [
        [(f, world) => stuckFor(BEARS, 0, world), `The spring does not begin slack: it pulls already.`],
        [(f, world) => stuckFor(PULLS, 0, world), `That is how long the spring took to be drawn so far.`],
        [(f, world) => stuckFor(BEARS, -PULLS, world), `Both forces point the same way: the spring lacks the rest only.`],
        [(f, world) => stuckFor(BEARS, PULLS, world) * world.speed, `That is how far it is carried, in µm. At which speed?`],
        [(f, world) => stuckFor(BEARS, PULLS, world) * 1000, `This is in ms. Answer in s.`],
      ],
      hint: `By how much may the spring’s force still grow, and how fast does it grow when its end moves at
        <var>V</var>?`,
    },
    {
      id: 'fastest',
      prompt: `Why is the slider hardly ever faster than the drive?`,
      options: [
        [`the damper takes away what is faster`, `Turn the damping down to a tenth and look again.`],
        [`friction drags it forward only while it is slower than the surface`],
        [
          `the spring holds it back`,
          `The same spring let it swing far faster than the drive when the speed was constant.`,
        ],
        [`the junctions are too small to push it so hard`, `The same junctions did so when the speed was constant.`],
      ],
    },
  ],
});
