use super::*;
use crate::layout::ChannelLayout;
use crate::window::FilmWindow;

const SIDE: u32 = 8;
const SAMPLES: u32 = 64;

/// Uniform numbers in [0, 1), for as long as anyone asks.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }
}

fn blocks() -> Vec<PixelBlock> {
    let size = (SIDE * SIDE) as usize;
    (0..4)
        .map(|i| PixelBlock {
            min: UVec2::new(SIDE * i, 0),
            max: UVec2::new(SIDE * (i + 1), SIDE),
            storage: i as usize * size..(i as usize + 1) * size,
        })
        .collect()
}

/// A film of two layers, whose samples a function of (block, number) makes.
fn film(seed: u64, sample: impl Fn(usize, &mut Numbers) -> [f32; 2]) -> Film {
    let layout = ChannelLayout {
        layers: vec!["direct".into(), "caustic".into()],
        variance: true,
        layer_variance: true,
        ..ChannelLayout::default()
    };
    let window = FilmWindow::full(UVec2::new(4 * SIDE, SIDE));
    let pixels: Vec<UVec2> = blocks()
        .iter()
        .flat_map(|block| (0..SIDE * SIDE).map(move |i| block.min + UVec2::new(i % SIDE, i / SIDE)))
        .collect();
    let mut film = Film::of_pixels(window, layout, &pixels).unwrap();
    let mut numbers = Numbers(seed);
    let end = film.pixel_count();
    for span in &mut film.spans_mut(0..end, 64) {
        for local in 0..span.len() {
            let block = span.pixel_of(local).x / SIDE;
            for number in 0..SAMPLES {
                let [direct, caustic] = sample(block as usize, &mut numbers);
                span.add_sample(local, number, &[[direct; 3], [caustic; 3]], 1.0, &[])
                    .unwrap();
            }
        }
    }
    film
}

fn audited(ours: &Film, traced: &Film) -> Audit {
    let options = AuditOptions {
        significance: 0.01,
        tolerance: 0.01,
        by_chance: vec![false, true],
        brightest: 500.0,
    };
    audit(ours, traced, &blocks(), &options).unwrap()
}

fn noise(_: usize, numbers: &mut Numbers) -> [f32; 2] {
    [2.0 * numbers.next(), 0.5 * numbers.next()]
}

#[test]
fn noise_is_no_finding_and_hardly_ever_looks_like_one() {
    let alarms = (0..40)
        .filter(|seed| {
            audited(&film(2 * seed, noise), &film(2 * seed + 1, noise))
                .findings()
                .count()
                > 0
        })
        .count();
    assert_eq!(alarms, 0, "of 40 audits, each with a chance of 1 %");
    // The chances are spread evenly: without tolerance, about every tenth is below 0.1.
    let options = AuditOptions {
        significance: 0.01,
        tolerance: 0.0,
        by_chance: vec![false, true],
        brightest: 500.0,
    };
    let mut low = 0.0;
    for seed in 0..100 {
        let (ours, traced) = (film(2 * seed, noise), film(2 * seed + 1, noise));
        let found = audit(&ours, &traced, &blocks()[..1], &options).unwrap();
        // Of three channels alike.
        let test = found.blocks.iter().find(|test| test.layer == Some(0)).unwrap();
        low += f64::from(crate::significance::p_value(test.t, test.freedom) < 0.1);
    }
    assert!((3.0..20.0).contains(&low), "{low} of 100");
}

#[test]
fn a_biased_block_is_found_and_named() {
    let traced = film(1, noise);
    let biased = film(2, |block, numbers| {
        let [direct, caustic] = noise(block, numbers);
        [direct * if block == 2 { 1.1 } else { 1.0 }, caustic]
    });
    let found = audited(&biased, &traced);
    let blocks: Vec<_> = found.findings().filter_map(|test| test.block).collect();
    assert!(
        !blocks.is_empty() && blocks.iter().all(|block| *block == 2),
        "{blocks:?}"
    );
    assert!(found.findings().all(|test| test.layer != Some(1) && test.t > 0.0));
    assert_eq!(found.samples, [SAMPLES; 2]);
    // What is too bright in all may be a caustic, for all that the tracer knows.
    assert!(found.undecided().all(|test| test.layer.is_none()));
}

#[test]
fn a_bias_within_the_tolerance_is_none() {
    let flat = |value: f32| film(1, move |_, numbers| [value + 1e-4 * numbers.next(), 0.0]);
    assert_eq!(audited(&flat(1.009), &flat(1.0)).findings().count(), 0);
    assert!(audited(&flat(0.98), &flat(1.0)).findings().count() > 0);
}

#[test]
fn light_that_few_samples_find_decides_nothing() {
    // A caustic that one sample in 4000 finds, against one that every sample has.
    let rare = film(1, |_, numbers| {
        [1.0, if numbers.next() < 1.0 / 4000.0 { 400.0 } else { 0.0 }]
    });
    let even = film(2, |_, numbers| [1.0, 0.2 * numbers.next()]);
    let found = audited(&even, &rare);
    assert_eq!(found.findings().count(), 0);
    let is_dark = |test: &AuditTest| test.layer != Some(0);
    assert!(found.undecided().count() > 0 && found.undecided().all(is_dark));
    // Nor does light that is even and may be only a part: a lamp that no sample has met may make up the rest.
    let part = film(1, |_, numbers| [1.0, 0.02 * numbers.next()]);
    let found = audited(&even, &part);
    assert_eq!(found.findings().count(), 0);
    assert!(found.undecided().count() > 0);
    // But there is no light too much where ours has too little, and no lamp so bright that is missed forever.
    assert!(audited(&part, &even).findings().count() > 0);
    let options = AuditOptions {
        significance: 0.01,
        tolerance: 0.01,
        by_chance: vec![false, true],
        brightest: 2.0,
    };
    let dim = audit(&even, &part, &blocks(), &options).unwrap();
    assert!(dim.findings().any(|test| test.layer == Some(1)));
    // A shadow that is not dark is a finding, since light that reaches it would be looked for.
    let shadow = film(1, |block, numbers| [if block == 1 { 0.0 } else { numbers.next() }, 0.0]);
    let leak = film(2, |_, numbers| [numbers.next(), 0.0]);
    assert!(audited(&leak, &shadow).findings().any(|test| test.block == Some(1)));
}

#[test]
fn films_that_cannot_be_compared_are_not() {
    let options = AuditOptions {
        significance: 0.01,
        tolerance: 0.0,
        by_chance: Vec::new(),
        brightest: 500.0,
    };
    let traced = film(1, noise);
    assert!(audit(&traced, &traced, &[], &options).is_none());
    let outside = [PixelBlock {
        storage: 0..10_000,
        ..blocks()[0].clone()
    }];
    assert!(audit(&traced, &traced, &outside, &options).is_none());
    let plain = ChannelLayout {
        layer_variance: false,
        ..traced.layout().clone()
    };
    let plain = Film::new(*traced.window(), plain, 8).unwrap();
    assert!(audit(&plain, &plain, &blocks(), &options).is_none());
}
