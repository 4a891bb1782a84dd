//! Whose spectra a table holds, and what follows from it: groups are cases of their own, and a table without angles allows
//! only models that need none.

use super::{JobError, JobFile};
use crate::measure::{GonioTable, Table};

/// One case a group, in the order of the table; the case as it is where the table has no groups.
pub(super) fn by_group(file: JobFile, table: Table) -> Vec<(JobFile, Table)> {
    let Table::Spectra(table) = table else { return vec![(file, table)] };
    let mut groups: Vec<&str> = Vec::new();
    for spectrum in &table.spectra {
        if !groups.contains(&spectrum.origin.group.as_str()) {
            groups.push(&spectrum.origin.group);
        }
    }
    if groups == [""] {
        return vec![(file, Table::Spectra(table))];
    }
    let part = |group: &&str| {
        let spectra = table.spectra.iter().filter(|spectrum| spectrum.origin.group == *group).cloned().collect();
        let mut file = file.clone();
        // The job's author never named the main case; the group's name says more.
        let named = file.case != super::file::MAIN_CASE;
        file.case = if named { format!("{}, {group}", file.case) } else { (*group).to_owned() };
        // A spectrum to be held out is of one group; a name that no group has stays, to be refused.
        file.data.hold_out.retain(|name| {
            let of = |spectrum: &&crate::measure::Spectrum| spectrum.id == *name;
            table.spectra.iter().find(of).is_none_or(|spectrum| spectrum.origin.group == *group)
        });
        (file, Table::Spectra(GonioTable { quantity: table.quantity, spectra }))
    };
    groups.iter().map(part).collect()
}

/// Refuses what needs angles where the table has none.
pub(super) fn check_geometry(file: &JobFile, table: &GonioTable) -> Result<(), JobError> {
    if !table.spectra.iter().any(|spectrum| spectrum.origin.without_geometry) {
        return Ok(());
    }
    if file.model.needs_geometry() {
        let problem = format!(
            "`{}` depends on where light and viewer stand, and the table's angles are \"not_recorded\"; use \
             `pigmented-base`, `film-at-unknown-angle` or `lambertian`, or write the angles in data.layout",
            file.model.card().kind
        );
        return Err(JobError::key("model.kind", problem));
    }
    let data = &file.data;
    for (key, is_given) in [
        ("data.theta_offset_deg", data.theta_offset_deg != 0.0),
        ("data.hold_out_near_mirror_deg", data.hold_out_near_mirror_deg > 0.0),
        ("data.hold_out_beyond_deg", data.hold_out_beyond_deg.is_some()),
        ("instrument.light_half_angle_deg", file.instrument.light_half_angle_deg > 0.0),
        ("instrument.viewer_half_angle_deg", file.instrument.viewer_half_angle_deg > 0.0),
    ] {
        if is_given {
            let problem =
                "this key speaks of angles, and the table's are \"not_recorded\"; leave it out, or write the angles";
            return Err(JobError::key(key, problem));
        }
    }
    Ok(())
}
