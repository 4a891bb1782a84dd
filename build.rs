//! Lets the tests on real measurements say that they were skipped: with `BARBULE_DATA` unset they are compiled as ignored,
//! with that reason, since a test cannot skip itself while it runs.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=BARBULE_DATA");
    println!("cargo::rustc-check-cfg=cfg(barbule_data)");
    if std::env::var_os("BARBULE_DATA").is_some() {
        println!("cargo::rustc-cfg=barbule_data");
    }
}
