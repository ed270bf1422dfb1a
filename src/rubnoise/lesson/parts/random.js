/* Random numbers that a seed repeats: the generator sfc32 (Chris Doty-Humphrey, PractRand). */
/** A stream of random numbers; streams of one seed and different names are independent of each other. */
class Random {
  constructor(seed, stream) {
    this.a = seed >>> 0;
    this.b = Math.floor(seed / 2 ** 32) >>> 0;
    this.c = stream >>> 0;
    this.counter = 1;
    this.spare = NaN;
    for (let i = 0; i < 20; i += 1) this.bits();
  }

  /** Return 32 random bits. */
  bits() {
    const out = (((this.a + this.b) | 0) + this.counter) | 0;
    this.counter = (this.counter + 1) | 0;
    this.a = this.b ^ (this.b >>> 9);
    this.b = (this.c + (this.c << 3)) | 0;
    this.c = (((this.c << 21) | (this.c >>> 11)) + out) | 0;
    return out >>> 0;
  }

  /** Return a uniform number on (0, 1), of 53 bits. */
  uniform() {
    return ((this.bits() >>> 5) * 67108864 + (this.bits() >>> 6) + 0.5) / 9007199254740992;
  }

  /** Return an exponential number of mean 1. */
  exponential() {
    return -Math.log(this.uniform());
  }

  /** Return a standard normal number, by Marsaglia's polar method, which makes them in pairs. */
  normal() {
    if (!Number.isNaN(this.spare)) {
      const kept = this.spare;
      this.spare = NaN;
      return kept;
    }
    for (;;) {
      const x = 2 * this.uniform() - 1;
      const y = 2 * this.uniform() - 1;
      const square = x * x + y * y;
      if (square < 1 && square > 0) {
        const factor = Math.sqrt((-2 * Math.log(square)) / square);
        this.spare = y * factor;
        return x * factor;
      }
    }
  }
}

rub.Random = Random;
