//! Where the real measurements are. They are not part of the project; `BARBULE_DATA` names their folder.

use std::path::PathBuf;

/// A file of the folder of measurements, as `gonio/teal_wing_patch.csv`.
///
/// A test that calls this carries
/// `#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]`.
pub(crate) fn data_file(name: &str) -> PathBuf {
    let folder = std::env::var_os("BARBULE_DATA").expect("BARBULE_DATA names the folder of measurements");
    let path = PathBuf::from(folder).join(name);
    assert!(path.is_file(), "BARBULE_DATA has no file {}", path.display());
    path
}
