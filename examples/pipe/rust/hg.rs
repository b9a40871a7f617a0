// Henyey-Greenstein directions about +z.  rustc -O --edition 2021 hg.rs && fogproof check --exec ./hg --spec ../hg.toml
mod fogproof;
use std::f64::consts::PI;

struct HenyeyGreenstein {
    g: f64,
    bug: bool, // --bug: wo points back to where the light came from
}

impl fogproof::Subject for HenyeyGreenstein {
    fn sample(&self, u: &[f64], row: &mut [f64]) {
        let g = self.g;
        let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * u[0]);
        let mu = if g.abs() > 1e-3 { (1.0 + g * g - root * root) / (2.0 * g) } else { 2.0 * u[0] - 1.0 };
        let (sine, phi) = ((1.0 - mu * mu).max(0.0).sqrt(), 2.0 * PI * u[1]);
        row[..3].copy_from_slice(&[sine * phi.cos(), sine * phi.sin(), if self.bug { -mu } else { mu }]);
        row[3] = self.pdf(&row[..3]);
    }
    fn pdf(&self, x: &[f64]) -> f64 {
        (1.0 - self.g * self.g) / (4.0 * PI * (1.0 + self.g * self.g - 2.0 * self.g * x[2]).powf(1.5))
    }
}

fn main() -> std::io::Result<()> {
    let bug = std::env::args().count() > 1;
    fogproof::serve(&["x", "x", "x", "pdf"], |p| HenyeyGreenstein { g: p.get("g", 0.8), bug })
}
