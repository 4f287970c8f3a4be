//! The section on the quality of the maps.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::report::Quality;
use crate::report::text::{escape, fixed, millimetres, scientific, trimmed};

/// The certificate of every map.
///
/// Implements: REP-041.
pub fn quality(page: &Page<'_>) -> String {
    let findings = page.findings;
    let reference = (
        &findings.reference.name,
        findings.reference.quality.as_ref(),
    );
    let others = findings
        .maps
        .iter()
        .map(|map| (&map.name, map.quality.as_ref()));
    let row = |(name, quality): (&String, Option<&Quality>)| {
        let mut row = vec![escape(name)];
        match quality {
            Some(quality) => row.extend(quality_cells(quality)),
            None => row.push("measured, no certificate".into()),
        }
        row
    };
    let rows: Vec<_> = [reference].into_iter().chain(others).map(row).collect();
    let number = |name| (name, "number");
    let head = [
        ("Map", ""),
        number("Mesh (mm)"),
        number("Nodes"),
        ("Element", ""),
        ("Contact", ""),
        number("Worst residual"),
        number("Worst imbalance (N)"),
        number("Largest band, normal force (± mN)"),
        number("Largest band, lateral force (± mN)"),
        number("Penetration (m)"),
        number("Smallest det(I + ∇u)"),
        number("at depth, x (mm)"),
        ("Version", ""),
    ];
    let caption = "Residual: the largest ‖Ku − f‖/‖f‖ of the linear solves. Imbalance: force on the probe against \
                   the reaction of floor and walls. Band: how far the mesh may leave a force from that of an infinitely fine \
                   one, from three meshes (grid convergence index), at the pose where it is widest. Penetration: the largest depth of a surface node inside the probe.";
    let table = Table {
        id: "table-certificates",
        caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(rows),
    };
    table.markup()
}

/// Implements: REP-044.
fn quality_cells(quality: &Quality) -> [String; 12] {
    [
        millimetres(quality.mesh_size),
        quality.nodes.to_string(),
        escape(&quality.element),
        escape(&quality.contact),
        scientific(quality.worst_relative_residual),
        scientific(quality.worst_force_balance),
        band(quality.largest_normal_band),
        band(quality.largest_lateral_band),
        scientific(quality.largest_penetration),
        fixed(quality.smallest_det, 3),
        format!(
            "{}, {}",
            millimetres(quality.smallest_det_depth),
            trimmed(quality.smallest_det_lateral * 1e3, 3)
        ),
        escape(&quality.program_version),
    ]
}

/// A band of the discretisation, N, in mN.
fn band(half_width: Option<f64>) -> String {
    half_width.map_or("not estimated".into(), |band| trimmed(1e3 * band, 2))
}
