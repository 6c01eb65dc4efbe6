use glam::Vec2;

/// Identifies the stage that draws numbers: a hash of its stable name.
///
/// Two stages with different names draw independent numbers, so adding a stage shifts nobody else's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageKey(u64);

impl StageKey {
    /// Hashes `name` (FNV-1a, 64 bits); usable in constants.
    #[must_use]
    pub const fn new(name: &str) -> Self {
        let bytes = name.as_bytes();
        let mut h = 0xcbf2_9ce4_8422_2325_u64;
        let mut i = 0;
        while i < bytes.len() {
            h = (h ^ bytes[i] as u64).wrapping_mul(0x0100_0000_01b3);
            i += 1;
        }
        Self(h)
    }
}

/// Mixes 64 bits so that every input bit flips every output bit with probability close to one half.
///
/// Source: Stafford's variant 13 of the `MurmurHash3` finaliser, as in Steele et al., "Fast Splittable Pseudorandom
/// Number Generators", OOPSLA 2014.
#[inline]
#[must_use]
pub const fn hash_u64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The random numbers of one sample: a pure function of (seed, stage, domain, sample index, bounce, dimension).
///
/// For each (bounce, dimension) the numbers of successive sample indices are an Owen-scrambled Sobol (0,2)-sequence,
/// shuffled independently of all other dimensions. Any aligned power-of-two run of indices is thus stratified in every
/// dimension pair; different pairs and different domains are independent.
///
/// Source: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020; the hash constants are those published by
/// N. Vegdahl in "Building a Better LK Hash", 2021.
#[derive(Clone, Copy, Debug)]
pub struct SampleStream {
    key: u64,
    index: u32,
}

impl SampleStream {
    /// The stream of sample `index` in `domain` (a pixel, or 0 where the index alone counts paths).
    #[inline]
    #[must_use]
    pub const fn new(seed: u64, stage: StageKey, domain: u64, index: u32) -> Self {
        let key = hash_u64(hash_u64(seed.wrapping_add(GOLDEN) ^ stage.0).wrapping_add(domain.wrapping_mul(GOLDEN)));
        Self { key, index }
    }

    /// The stream of sample `number` in `domain`, whose samples are dealt to several sequences in turn, `run` at a time.
    ///
    /// Each is scrambled on its own and grows with the samples, so that their estimates are independent and their spread
    /// tells the error of the mean. One sequence of all samples has less error where the integrand is smooth, which cannot
    /// be told from inside.
    #[inline]
    #[must_use]
    pub const fn dealt(seed: u64, stage: StageKey, domain: u64, number: u32, (sequences, run): (u32, u32)) -> Self {
        let round = number / (run * sequences);
        let sequence = (number / run) % sequences;
        let key = domain.wrapping_mul(sequences as u64).wrapping_add(sequence as u64);
        Self::new(seed, stage, key, round * run + number % run)
    }

    /// The stream of part `number` of `count` parts that a stage splits this sample into, such as the rays of one hit.
    ///
    /// The parts of all samples of a domain together are one sequence: stratified within a sample and, where `count` is a
    /// power of two, from sample to sample.
    #[inline]
    #[must_use]
    pub const fn split(&self, stage: StageKey, count: u32, number: u32) -> Self {
        Self {
            key: hash_u64(self.key ^ stage.0),
            index: self.index.wrapping_mul(count).wrapping_add(number),
        }
    }

    /// The sample index.
    #[inline]
    #[must_use]
    pub const fn index(&self) -> u32 {
        self.index
    }

    #[inline]
    const fn dimension_key(&self, bounce: u32, dimension: u32) -> u64 {
        hash_u64(self.key ^ (((bounce as u64) << 32) | dimension as u64).wrapping_mul(GOLDEN))
    }

    /// Draws one number in [0, 1), 24 bits.
    #[inline]
    #[must_use]
    pub fn draw_1d(&self, bounce: u32, dimension: u32) -> f32 {
        let key = self.dimension_key(bounce, dimension);
        let index = owen_scramble_reversed(self.index.reverse_bits(), key as u32).reverse_bits();
        unit_float(owen_scramble_reversed(index, (key >> 32) as u32).reverse_bits())
    }

    /// Draws two numbers in [0, 1), 24 bits each, jointly stratified over the sample index.
    #[inline]
    #[must_use]
    pub fn draw_2d(&self, bounce: u32, dimension: u32) -> Vec2 {
        let key = self.dimension_key(bounce, dimension);
        let second = (hash_u64(key) >> 32) as u32;
        let index = owen_scramble_reversed(self.index.reverse_bits(), key as u32).reverse_bits();
        let x = owen_scramble_reversed(index, (key >> 32) as u32);
        let y = owen_scramble_reversed(sobol_second_reversed(index), second);
        Vec2::new(unit_float(x.reverse_bits()), unit_float(y.reverse_bits()))
    }
}

/// Second Sobol dimension, bit-reversed: bit k of the result is the parity of the index bits j ⊇ k.
///
/// Its generator matrix is Pascal's triangle modulo 2, which is 1 where k is a bitwise subset of j (Lucas), so that the
/// product takes five steps of a superset sum.
#[inline]
const fn sobol_second_reversed(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ ((x >> 16) & 0x0000_ffff)
}

/// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it.
#[inline]
const fn owen_scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[inline]
fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: StageKey = StageKey::new("test");

    #[test]
    fn every_aligned_power_of_two_is_a_net_in_base_two() {
        for (domain, log2_n) in [(0_u64, 4_u32), (1, 6), (77, 8)] {
            let n = 1_u32 << log2_n;
            for start in [0, n, 3 * n] {
                let points: Vec<Vec2> = (start..start + n)
                    .map(|i| SampleStream::new(5, KEY, domain, i).draw_2d(2, 9))
                    .collect();
                for log2_x in 0..=log2_n {
                    let (nx, ny) = (1_u32 << log2_x, n >> log2_x);
                    let mut seen = vec![false; n as usize];
                    for p in &points {
                        let cell = (p.x * nx as f32) as usize * ny as usize + (p.y * ny as f32) as usize;
                        assert!(!seen[cell], "two points in one elementary interval");
                        seen[cell] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn one_dimension_is_stratified_and_differs_between_keys() {
        let n = 64;
        let mut seen = [false; 64];
        for i in 0..n {
            seen[(SampleStream::new(0, KEY, 3, i).draw_1d(0, 0) * n as f32) as usize] = true;
        }
        assert!(seen.iter().all(|s| *s));
        let a = SampleStream::new(0, KEY, 3, 0);
        for b in [
            SampleStream::new(1, KEY, 3, 0).draw_1d(0, 0),
            SampleStream::new(0, StageKey::new("other"), 3, 0).draw_1d(0, 0),
            SampleStream::new(0, KEY, 4, 0).draw_1d(0, 0),
            a.draw_1d(1, 0),
            a.draw_1d(0, 1),
        ] {
            assert_ne!(a.draw_1d(0, 0), b);
        }
    }

    #[test]
    fn dealt_samples_are_sequences_of_their_own() {
        for number in 0..64 {
            let (sequence, index) = (number / 4 % 8, number / 32 * 4 + number % 4);
            let dealt = SampleStream::dealt(5, KEY, 3, number, (8, 4));
            let own = SampleStream::new(5, KEY, 3 * 8 + u64::from(sequence), index);
            assert_eq!(dealt.draw_2d(1, 2), own.draw_2d(1, 2));
            let single = SampleStream::dealt(5, KEY, 3, number, (1, 4));
            assert_eq!(single.draw_1d(0, 0), SampleStream::new(5, KEY, 3, number).draw_1d(0, 0));
        }
    }

    #[test]
    fn different_dimensions_are_uncorrelated() {
        let n = 4096;
        let mut sum = 0.0_f64;
        for i in 0..n {
            let s = SampleStream::new(9, KEY, 1, i);
            sum += f64::from(s.draw_1d(0, 0) - 0.5) * f64::from(s.draw_1d(0, 1) - 0.5);
        }
        // Standard error of the correlation estimate is (1/12)/√n = 0.0013; four of them are allowed.
        assert!((sum / f64::from(n)).abs() < 0.0052);
    }
}
