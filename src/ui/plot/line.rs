//! The line of a curve as a shape.

use eframe::egui::{Color32, Mesh, Pos2, Shape, Stroke, pos2, vec2};

/// Lines of more points go up and down in every column of the picture. Smooth edges cost ten times as much there as
/// plain ones, and are not seen.
const DENSE: usize = 600;

/// A line through these points; a dot where there is only one.
pub fn line(points: Vec<Pos2>, stroke: Stroke) -> Shape {
    match points.as_slice() {
        [alone] => Shape::circle_filled(*alone, stroke.width, stroke.color),
        dense if dense.len() > DENSE => Shape::mesh(ribbon(dense, stroke.width, stroke.color)),
        _ => Shape::line(points, stroke),
    }
}

/// A rectangle for each piece of the line.
fn ribbon(points: &[Pos2], width: f32, colour: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(points.len().saturating_mul(4));
    mesh.reserve_triangles(points.len().saturating_mul(2));
    for (from, to) in points.iter().zip(points.iter().skip(1)) {
        let along = (*to - *from).normalized();
        let across = vec2(-along.y, along.x) * (width / 2.0);
        let Ok(first) = u32::try_from(mesh.vertices.len()) else { break };
        for corner in [*from + across, *from - across, *to + across, *to - across] {
            mesh.colored_vertex(pos2(corner.x, corner.y), colour);
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dense_line_reaches_every_point() {
        let points: Vec<Pos2> =
            (0..2_000).map(|i| pos2(i as f32 / 2.0, if i % 2 == 0 { 10.0 } else { 90.0 })).collect();
        let shape = line(points.clone(), Stroke::new(1.5, Color32::WHITE));
        let Shape::Mesh(mesh) = &shape else { panic!("it is drawn with smooth edges") };
        assert_eq!(mesh.vertices.len(), (points.len() - 1) * 4);
        let bounds = shape.visual_bounding_rect();
        assert!(points.iter().all(|point| bounds.contains(*point)));
        assert!(mesh.is_valid());
    }

    #[test]
    fn a_plain_line_has_smooth_edges_and_a_single_sample_is_a_dot() {
        let stroke = Stroke::new(1.5, Color32::WHITE);
        assert!(matches!(line(vec![Pos2::ZERO, pos2(9.0, 9.0)], stroke), Shape::Path(_) | Shape::LineSegment { .. }));
        assert!(matches!(line(vec![Pos2::ZERO], stroke), Shape::Circle(_)));
    }
}
