use barbule::bsdf::{Direction, Model, RoughPlastic, RoughPlasticDesign};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn dirs(n: usize, seed: u64) -> Vec<Direction> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..n).map(|_| { let c: f64 = random.random(); let (sp, cp) = random.random_range(0.0..std::f64::consts::TAU).sin_cos(); let s = (1.0 - c * c).sqrt(); Direction::new(s * cp, s * sp, c) }).collect()
}
fn main() {
    let n = 1 << 20;
    let model = RoughPlastic::new(&RoughPlasticDesign::default(), &[645.0, 525.0, 445.0]).unwrap();
    let mut v: Vec<f64> = model.parameters().iter().map(|p| p.default).collect();
    v[..2].copy_from_slice(&[0.3, 1.55]);
    let b = model.bind(&v);
    let (i, o) = (dirs(n, 1), dirs(n, 2));
    let mut out = vec![0.0; 3 * n];
    b.evaluate_many(&i, &o, &mut out);
    for _ in 0..5 {
        let t = cpu();
        for _ in 0..10 { b.evaluate_many(&i, &o, &mut out); }
        println!("{:.1} M/s per core-second", 10.0 * n as f64 / (cpu() - t) / 1e6);
    }
    println!("{}", out[17]);
}
