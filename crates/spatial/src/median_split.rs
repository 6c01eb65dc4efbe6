//! The tree builder for input that defeats the better one.

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// Builds a binary tree by halving the primitives along the longest axis of their centres, until one is left.
///
/// Slower to walk than one built by locally-ordered clustering, but its depth is ⌈log₂ n⌉ whatever the input: thousands
/// of primitives in the same place are none the worse. Ties are broken by index.
pub(crate) fn build(boxes: &[Aabb]) -> Bvh2 {
    let mut tree = Bvh2::zeroed(boxes.len());
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut next = 1;
    let mut open = vec![(0, 0, boxes.len())];
    while let Some((node, start, end)) = open.pop() {
        let run = &mut order[start..end];
        let bounds = run.iter().fold(Aabb::INVALID, |all, i| all.union(&boxes[*i as usize]));
        if let [only] = run {
            tree.nodes[node] = Bvh2Node::new(bounds, 1, *only);
            continue;
        }
        let mut centers = Aabb::INVALID;
        for i in run.iter() {
            centers.extend(boxes[*i as usize].center());
        }
        let extent = (centers.max - centers.min).to_array();
        let axis = (0..3).fold(0, |best, a| if extent[a] > extent[best] { a } else { best });
        let half = run.len() / 2;
        let along = |i: &u32| boxes[*i as usize].center()[axis];
        run.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        tree.nodes[node] = Bvh2Node::new(bounds, 0, next as u32);
        open.push((next + 1, start + half, end));
        open.push((next, start, start + half));
        next += 2;
    }
    tree.primitive_indices = (0..boxes.len() as u32).collect();
    tree
}
