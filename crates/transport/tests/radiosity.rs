//! Radiosity against closed forms: form factors, closed rooms, lights, borders.

mod common;

use common::{at, black, diffuse, floor, glass, point_light, scene};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use radiometry::Rgb;
use scattering::{Bsdf, DielectricBsdf, Microsurface};
use spatial::{Ray, Shape};
use std::f64::consts::PI;
use transport::{
    ExchangeError, ExchangeSettings, FormFactors, LightSource, Material, PatchField, PatchScratch, PathMedium,
    PlaceError, PlaceSettings, Scene, Vertex, find_direct, find_form_factors,
};

const EXCHANGE: ExchangeSettings = ExchangeSettings {
    rays: 256,
    seed: 3,
    most_links: 1 << 24,
};

fn place(scene: &Scene, points: u32) -> PatchField {
    let settings = PlaceSettings {
        size: None,
        usual: points,
        most: 1 << 20,
    };
    PatchField::place(scene, &settings).expect("few patches")
}

/// Form factors of all sides where nothing is lit, and so all are looked at.
fn factors(scene: &Scene, field: &mut PatchField) -> FormFactors {
    find_form_factors(scene, field, &EXCHANGE, |_| true).expect("few form factors")
}

fn unit_quad() -> Shape {
    Shape::Quad { size: Vec2::ONE }
}

fn room() -> Shape {
    Shape::Cuboid {
        size: Vec3::new(2.0, 2.0, 2.0),
    }
}

/// Mean form factor of the upper side of instance 0 with instance 1.
fn factor_between(shapes: &[(Shape, DAffine3, Material)]) -> f64 {
    let scene = scene(shapes, Vec::new());
    let mut field = place(&scene, 800);
    let factors = factors(&scene, &mut field);
    let patches = field.patches();
    let (mut sum, mut area) = (0.0, 0.0);
    for (row, patch) in patches
        .iter()
        .enumerate()
        .filter(|(row, patch)| patch.instance == 0 && row % 2 == 0)
    {
        let seen = factors
            .row(row)
            .iter()
            .filter(|(to, _)| patches[*to as usize].instance == 1);
        sum += f64::from(patch.area) * seen.map(|(_, factor)| f64::from(factor.g)).sum::<f64>();
        area += f64::from(patch.area);
    }
    sum / area
}

#[test]
fn form_factors_of_squares_are_those_of_the_textbook() {
    // Howell, "A Catalog of Radiation Heat Transfer Configuration Factors": C-11 and C-14.
    let facing = at(0.0, 1.0, 0.0) * floor();
    let parallel = factor_between(&[
        (unit_quad(), floor(), diffuse(0.5)),
        (unit_quad(), facing, diffuse(0.5)),
    ]);
    assert!((parallel - 0.199_825).abs() < 0.002, "parallel: {parallel}");
    let wall = at(0.0, 0.5, -0.5);
    let perpendicular = factor_between(&[(unit_quad(), floor(), diffuse(0.5)), (unit_quad(), wall, diffuse(0.5))]);
    assert!(
        (perpendicular - 0.200_044).abs() < 0.002,
        "perpendicular: {perpendicular}"
    );
}

#[test]
fn form_factors_of_a_closed_room_add_up_to_one() {
    let ball = Shape::Sphere { radius: 0.4 };
    let scene = scene(
        &[
            (room(), at(0.0, 0.0, 0.0), diffuse(0.5)),
            (ball, at(0.3, 0.1, 0.0), diffuse(0.5)),
        ],
        Vec::new(),
    );
    let mut field = place(&scene, 600);
    let factors = factors(&scene, &mut field);
    for (row, patch) in field.patches().iter().enumerate() {
        let sum: f32 = factors.row(row).iter().map(|(_, factor)| factor.g).sum();
        // The outside of the room sees nothing.
        let expected = if patch.instance == 0 && row % 2 == 0 { 0.0 } else { 1.0 };
        assert!((sum - expected).abs() < 1e-5, "{row}: {sum}");
    }
}

/// An emitting box, from inside.
fn furnace(albedo: f32) -> Scene {
    let light = LightSource::Area {
        instance: 0,
        radiance: Rgb::splat(1.0 - albedo),
        texture: None,
        two_sided: true,
    };
    scene(&[(room(), at(0.0, 0.0, 0.0), diffuse(albedo))], vec![light])
}

fn solved(scene: &Scene, points: u32) -> PatchField {
    let mut field = place(scene, points);
    find_direct(scene, &mut field, &EXCHANGE, |_| true).expect("nobody stops it");
    let factors = factors(scene, &mut field);
    let solution = factors.solve(&mut field, 0.01, u32::MAX);
    assert!(solution.estimated <= 0.01 && solution.rounds > 1, "{solution:?}");
    field
}

#[test]
fn a_furnace_is_as_bright_as_its_albedo_says() {
    for albedo in [0.5, 0.8] {
        // L = 1, so that E = π, of which the lamp itself brings 1 − ρ.
        let field = solved(&furnace(albedo), 500);
        let inside: Vec<_> = field.patches().iter().skip(1).step_by(2).collect();
        let mean = |value: &dyn Fn(&transport::Patch) -> Rgb| {
            inside.iter().map(|patch| f64::from(value(patch).g)).sum::<f64>() / inside.len() as f64 / PI
        };
        let (direct, indirect) = (mean(&|p| p.direct), mean(&|p| p.indirect));
        assert!((direct - f64::from(1.0 - albedo)).abs() < 0.004, "{albedo}: {direct}");
        assert!((indirect - f64::from(albedo)).abs() < 0.004, "{albedo}: {indirect}");
    }
}

#[test]
fn light_of_every_kind_reaches_patches() {
    let distant = LightSource::Distant {
        frame: common::frame(Vec3::ZERO, glam::DQuat::from_rotation_x(-PI / 2.0)),
        irradiance: Rgb::splat(2.0),
        half_angle: 0.0,
    };
    let above = point_light(Vec3::new(0.0, 100.0, 0.0), Rgb::splat(1e4));
    let sky = LightSource::Environment(transport::Environment::uniform(Rgb::splat(1.0)));
    let tiny = Shape::Quad {
        size: Vec2::splat(0.01),
    };
    for (name, light, expected) in [("distant", distant, 2.0), ("point", above, 1.0), ("sky", sky, PI)] {
        let scene = scene(&[(tiny, floor(), diffuse(0.5))], vec![light]);
        let mut field = place(&scene, 1);
        find_direct(&scene, &mut field, &EXCHANGE, |_| true).expect("nobody stops it");
        let factors = factors(&scene, &mut field);
        assert!(factors.is_empty(), "a quad alone sees nothing");
        for patch in field.patches().iter().step_by(2) {
            assert!(
                (f64::from(patch.direct.g) - expected).abs() < 0.02 * expected,
                "{name}: {patch:?}"
            );
        }
        let below = field.patches()[1].direct.g;
        assert!(
            if name == "sky" { below > 3.0 } else { below == 0.0 },
            "{name}: {below}"
        );
    }
}

#[test]
fn light_goes_on_over_mirrors_and_through_glass() {
    // Between floor and ceiling hangs a pane that only sends light on.
    let ceiling = at(0.0, 1.0, 0.0) * floor();
    let pane = Shape::Cuboid {
        size: Vec3::new(8.0, 0.01, 8.0),
    };
    let with = |middle: Material| {
        factor_between(&[
            (unit_quad(), floor(), diffuse(0.5)),
            (unit_quad(), ceiling, diffuse(0.5)),
            (pane, at(0.0, 0.5, 0.0), middle),
        ])
    };
    assert_eq!(with(black()), 0.0);
    let through = with(glass(0.0));
    // Some 9 % are reflected at 1.5, more at an angle.
    assert!((0.15..0.19).contains(&through), "{through}");
}

#[test]
fn a_room_that_only_a_lamp_behind_glass_lights_is_not_dark() {
    let cube = |side: f32| Shape::Cuboid {
        size: Vec3::splat(side),
    };
    let middle = at(0.0, 0.0, 0.0);
    // It bends and reflects no light, but who samples lights does not see through it.
    let clear = Material {
        bsdf: Bsdf::Dielectric(DielectricBsdf::new(1.0, Rgb::WHITE, Microsurface::SMOOTH)),
        ..Material::default()
    };
    let shapes = [
        (cube(2.0), middle, diffuse(0.5)),
        (cube(0.4), middle, black()),
        (cube(0.6), middle, clear),
    ];
    let lamp = LightSource::Area {
        instance: 1,
        radiance: Rgb::splat(1.0),
        texture: None,
        two_sided: false,
    };
    // It lights the outside alone, where no ray finds a way in.
    let sun = LightSource::Distant {
        frame: common::frame(Vec3::ZERO, glam::DQuat::IDENTITY),
        irradiance: Rgb::splat(1.0),
        half_angle: 0.0,
    };
    let scene = scene(&shapes, vec![lamp, sun]);
    let mut field = place(&scene, 1000);
    find_direct(&scene, &mut field, &EXCHANGE, |_| true).expect("nobody stops it");
    factors(&scene, &mut field);
    let inside = field.patches().iter().skip(1).step_by(2);
    let flux: f64 = inside.map(|patch| f64::from(patch.direct.g * patch.area)).sum();
    let sent = PI * 6.0 * 0.4 * 0.4;
    assert!((flux / sent - 1.0).abs() < 0.01, "{flux} of {sent}");
}

/// The vertex that a ray meets.
fn with_vertex<T>(scene: &Scene, origin: Vec3, direction: Vec3, use_it: impl FnOnce(&Vertex<'_>) -> T) -> T {
    let ray = Ray::new(origin, direction.normalize());
    let hit = scene.rays.intersect(&ray).expect("something is there");
    let point = scene.rays.surface(&ray, &hit);
    use_it(&Vertex::new(scene, &point, -ray.direction, &PathMedium::VACUUM))
}

#[test]
fn linear_light_is_read_exactly_up_to_the_border_and_not_through_walls() {
    let wall = Shape::Cuboid {
        size: Vec3::new(0.02, 0.5, 2.0),
    };
    let quad = Shape::Quad { size: Vec2::splat(2.0) };
    let scene = scene(
        &[(quad, floor(), diffuse(0.5)), (wall, at(0.0, 0.25, 0.0), diffuse(0.5))],
        Vec::new(),
    );
    let mut field = place(&scene, 1500);
    // A ramp on one side of the wall, dark on the other.
    for patch in field.patches_mut() {
        let lit = patch.instance == 0 && patch.normal.y > 0.0 && patch.position.x > 0.0;
        patch.indirect = Rgb::splat(if lit {
            1.0 + 2.0 * patch.position.x + patch.position.z
        } else {
            0.0
        });
    }
    let mut scratch = PatchScratch::default();
    for i in 0..200 {
        let (x, z) = (
            0.02 + 0.97 * (0.618 * i as f32).fract(),
            -0.97 + 1.94 * i as f32 / 200.0,
        );
        let mut read = |x: f32| {
            with_vertex(&scene, Vec3::new(x, 0.4, z), -Vec3::Y, |vertex| {
                field
                    .indirect_irradiance(&scene, vertex, &mut scratch)
                    .expect("patches are near")
                    .g
            })
        };
        let (lit, dark) = (read(x), read(-x));
        assert!((lit - (1.0 + 2.0 * x + z)).abs() < 0.06, "{x}, {z}: {lit}");
        assert_eq!(dark, 0.0, "{x}, {z}");
    }
}

#[test]
fn patches_and_form_factors_have_a_bound() {
    let scene = furnace(0.5);
    let tiny = PlaceSettings {
        size: Some(1e-4),
        usual: 1,
        most: 1000,
    };
    let refused = PatchField::place(&scene, &tiny).expect_err("too many");
    let PlaceError::TooMany { points, possible_size } = refused else {
        panic!("{refused:?}")
    };
    assert!(points > 1e9);
    let enough = PlaceSettings {
        size: possible_size,
        ..tiny
    };
    let mut field = PatchField::place(&scene, &enough).expect("what was advised");
    let few = ExchangeSettings {
        most_links: 10,
        ..EXCHANGE
    };
    assert_eq!(
        find_form_factors(&scene, &mut field, &few, |_| true).err(),
        Some(ExchangeError::TooMany)
    );
    assert_eq!(
        find_direct(&scene, &mut field, &few, |_| false),
        Err(ExchangeError::Stopped)
    );
    let nothing = scene_without_surfaces();
    let mut empty = place(&nothing, 100);
    assert!(empty.patches().is_empty());
    factors(&nothing, &mut empty).solve(&mut empty, 0.01, u32::MAX);
}

fn scene_without_surfaces() -> Scene {
    scene(
        &[(unit_quad(), DAffine3::from_translation(DVec3::Y), black())],
        Vec::new(),
    )
}

#[test]
fn solutions_are_the_same_on_any_number_of_threads() {
    let scene = furnace(0.7);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| solved(&scene, 100)).patches().to_vec()
    };
    assert_eq!(on(1), on(3));
}
