//! The incomplete gamma function, for tails of χ².

/// Terms beyond which a sum or a fraction ends: some ten times the root of the largest parameter that is asked for.
const TERMS: usize = 100_000;

/// Regularised upper incomplete gamma function Q(a, x): the share of Γ(a) = ∫ t^(a−1) e^−t dt from 0 to ∞ above x; a > 0, x
/// ≥ 0.
pub(super) fn upper_share(a: f64, x: f64) -> f64 {
    let factor = (a * x.ln() - x - ln_gamma(a)).exp();
    if factor == 0.0 {
        return if x < a { 1.0 } else { 0.0 };
    }
    if x < a + 1.0 {
        1.0 - factor * lower_sum(a, x)
    } else {
        factor * upper_fraction(a, x)
    }
}

/// Σ xⁿ / (a (a+1) … (a+n)), which converges fast below a.
fn lower_sum(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..TERMS {
        term *= x / (a + n as f64);
        sum += term;
        if term < sum * f64::EPSILON {
            break;
        }
    }
    sum
}

/// Legendre's continued fraction, which converges fast above a; from its head on (Lentz 1976).
fn upper_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / f64::MIN_POSITIVE, 1.0 / b);
    let mut value = d;
    for n in 1..TERMS {
        let n = n as f64;
        let numerator = n * (a - n);
        b += 2.0;
        d = 1.0 / kept_from_0(b + numerator * d);
        c = kept_from_0(b + numerator / c);
        value *= c * d;
        if (c * d - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

fn kept_from_0(x: f64) -> f64 {
    if x.abs() < f64::MIN_POSITIVE {
        f64::MIN_POSITIVE
    } else {
        x
    }
}

/// ln Γ(a) for a > 0: Stirling's series, beyond a number from which on it is exact.
fn ln_gamma(a: f64) -> f64 {
    const EXACT_FROM: f64 = 12.0;
    let (mut at, mut below) = (a, 1.0);
    while at < EXACT_FROM {
        below *= at;
        at += 1.0;
    }
    let inverse = 1.0 / (at * at);
    let series = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
    ];
    let series = series.iter().rev().fold(0.0, |sum, term| sum * inverse + term) / at;
    (at - 0.5) * at.ln() - at + 0.5 * std::f64::consts::TAU.ln() + series - below.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_near(found: f64, expected: f64, tolerance: f64) {
        let error = (found / expected - 1.0).abs();
        assert!(error < tolerance, "{found} instead of {expected}: off by {error}");
    }

    #[test]
    fn the_share_above_is_the_tail_of_a_poisson_sum_for_whole_parameters() {
        // Γ(n, x)/Γ(n) = e^−x Σ x^k/k! over k < n.
        for n in [1, 2, 3, 7, 20, 60] {
            for x in [0.01, 0.5, 1.0, 3.0, 9.5, 21.0, 40.0, 80.0, 200.0] {
                let terms = (1..n).scan(1.0, |term, k| {
                    *term *= x / f64::from(k);
                    Some(*term)
                });
                let expected = (-x).exp() * (1.0 + terms.sum::<f64>());
                assert_near(upper_share(f64::from(n), x), expected, 1e-12);
            }
        }
    }

    #[test]
    fn the_share_above_steps_by_the_recurrence_between_half_parameters() {
        // Γ(a+1, x)/Γ(a+1) − Γ(a, x)/Γ(a) = x^a e^−x / Γ(a+1).
        for a in [0.5, 1.5, 4.5, 11.5, 49.5, 500.5, 20_000.5] {
            for share in [0.3, 0.9, 1.0, 1.1, 1.6] {
                let x: f64 = a * share;
                let step = (a * x.ln() - x - ln_gamma(a + 1.0)).exp();
                let found = upper_share(a + 1.0, x) - upper_share(a, x);
                assert!(
                    (found - step).abs() < 1e-10 * (1.0 + step),
                    "{a}, {x}: {found} instead of {step}"
                );
            }
        }
    }

    #[test]
    fn known_quantiles_of_chi_square_are_met() {
        let known = [
            (1.0, 3.841_458_820_694_124),
            (10.0, 18.307_038_053_275_146),
            (100.0, 124.342_113_404_004_07),
        ];
        for (freedom, quantile) in known {
            assert_near(upper_share(0.5 * freedom, 0.5 * quantile), 0.05, 1e-12);
        }
        // 1 − erf(1), with one degree of freedom.
        assert_near(upper_share(0.5, 1.0), 0.157_299_207_050_285_13, 1e-13);
        assert_near(ln_gamma(0.5), 0.5 * std::f64::consts::PI.ln(), 1e-13);
        assert_eq!(upper_share(0.5, 1e6), 0.0);
    }
}
