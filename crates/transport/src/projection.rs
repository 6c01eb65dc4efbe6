use glam::Vec3;

/// A sphere that photons are aimed at: around one specular object, or around a few of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetSphere {
    /// Centre, world space, metres.
    pub centre: Vec3,
    /// Radius, metres.
    pub radius: f32,
}

/// Most spheres that emission aims at; more objects than that are grouped.
pub const MAX_TARGETS: usize = 32;

/// Groups spheres until at most [`MAX_TARGETS`] are left, each result enclosing its group.
///
/// Splits at the median of the longest side of the centres, five levels deep, ties by index: deterministic.
#[must_use]
pub fn cluster_targets(mut targets: Vec<TargetSphere>) -> Vec<TargetSphere> {
    if targets.len() <= MAX_TARGETS {
        return targets;
    }
    let mut out = Vec::with_capacity(MAX_TARGETS);
    split(&mut targets, MAX_TARGETS, &mut out);
    out
}

fn split(targets: &mut [TargetSphere], leaves: usize, out: &mut Vec<TargetSphere>) {
    if leaves <= 1 || targets.len() <= 1 {
        if !targets.is_empty() {
            out.push(enclose(targets));
        }
        return;
    }
    let (low, high) = targets
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), t| {
            (low.min(t.centre), high.max(t.centre))
        });
    let size = high - low;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    targets.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let (left, right) = targets.split_at_mut(targets.len() / 2);
    split(left, leaves / 2, out);
    split(right, leaves - leaves / 2, out);
}

fn enclose(targets: &[TargetSphere]) -> TargetSphere {
    let (low, high) = targets
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), t| {
            (low.min(t.centre - t.radius), high.max(t.centre + t.radius))
        });
    let centre = 0.5 * (low + high);
    let radius = targets
        .iter()
        .map(|t| t.centre.distance(centre) + t.radius)
        .fold(0.0, f32::max);
    TargetSphere { centre, radius }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_enclose_every_target() {
        let all: Vec<_> = (0..1000)
            .map(|i| TargetSphere {
                centre: Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32),
                radius: 0.1,
            })
            .collect();
        let groups = cluster_targets(all.clone());
        assert_eq!(groups.len(), MAX_TARGETS);
        for t in all {
            assert!(
                groups
                    .iter()
                    .any(|g| g.centre.distance(t.centre) + t.radius <= g.radius * 1.000_01)
            );
        }
    }
}
