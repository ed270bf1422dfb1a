/* Judges a student's answer: a number within a stated tolerance, a choice, or a task done with the knobs. */
const { lessons, answers } = rub;
const ROUNDING = 1e-9;

const right = (message = 'Right.') => ({ right: true, message });
const wrong = (message) => ({ right: false, message });

/** Return whether a value is within a relative tolerance of another; nothing but 0 is near 0. */
const near = (value, wanted, tolerance) => Math.abs(value - wanted) <= (tolerance + ROUNDING) * Math.abs(wanted);

/** Return the hint of the first known wrong answer that a value is near to, else the general one. */
function hintFor(check, value, exact, world) {
  const known = (check.hints ?? []).find(([mistake]) => near(value, lessons.given(mistake, exact, world), check.tolerance));
  return known ? known[1] : check.hint;
}

function judgeNumber(check, text, exact, world) {
  const read = answers.read(text, check.unit ?? '');
  if (read.problem) return wrong(read.problem);
  const wanted = [lessons.given(check.expected, exact, world)].flat();
  if (wanted.some((each) => near(read.value, each, check.tolerance))) {
    return right(`Right: ${lessons.words.withUnit(wanted[0], check.unit)}.`);
  }
  if (isShareOfHundred(check, read.value, wanted)) return wrong('As a share, or with the % sign?');
  return wrong(`Not yet. ${hintFor(check, read.value, exact, world)}`);
}

function isShareOfHundred(check, value, wanted) {
  return !check.unit && wanted.some((each) => each < 1 && near(value, 100 * each, check.tolerance));
}

function judgeChoice(check, chosen) {
  if (!check.options[chosen]) return wrong('Choose an answer first.');
  const [, hint] = check.options[chosen]; // the right answer has none
  return hint ? wrong(`Not yet. ${hint}`) : right();
}

/**
 * Judge an answer.
 * @param {object} lesson the lesson
 * @param {object} check one of its checks: with options, with `met` for a task, else a number
 * @param {string} answer what was typed, or the number of what was chosen
 * @returns {{right: boolean, message: string}} the verdict and what to say (HTML)
 */
function judge(lesson, check, answer) {
  const { world } = rub;
  const exact = rub.exact();
  const misfit = lessons.misfit(lesson, world);
  if (misfit) return wrong(misfit);
  if (check.options) return judgeChoice(check, answer);
  if (check.met) return check.met(exact, world) ? right() : wrong(`Not yet. ${check.hint(exact, world)}`);
  return judgeNumber(check, answer, exact, world);
}

lessons.judge = judge;
