//! Non-negative least squares by active sets (Lawson and Hanson 1974), on the normal equations (Bro and De Jong 1997).

/// Gradient, relative to the largest product with the right side, from which a variable is freed.
const GAIN_MIN: f64 = 1e-13;
/// Times the number of variables: rounds after which the best that was found has to do.
const ROUNDS: usize = 10;

/// The x without negative components that minimises ½ xᵀ·gram·x − right·x; gram is symmetric and positive definite.
/// `None` where it is not, or a number is not finite.
pub(super) fn non_negative(gram: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    if !gram.iter().flatten().chain(right).all(|x| x.is_finite()) {
        return None;
    }
    let count = right.len();
    let least = GAIN_MIN * right.iter().fold(0.0, |most, x| x.abs().max(most));
    let mut x = vec![0.0; count];
    let mut free: Vec<usize> = Vec::new();
    // Variables that only rounding made promising since the last real step.
    let mut refused: Vec<usize> = Vec::new();
    for _ in 0..ROUNDS * count {
        let gain = |i: usize| right[i] - gram[i].iter().zip(&x).map(|(g, x)| g * x).sum::<f64>();
        let fixed = (0..count).filter(|i| !free.contains(i) && !refused.contains(i));
        let best = fixed.map(|i| (i, gain(i))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((entering, _)) = best.filter(|(_, gain)| *gain > least) else {
            break;
        };
        free.push(entering);
        loop {
            let wanted = minimum(gram, right, &free)?;
            if step(&mut x, &mut free, &wanted) {
                break;
            }
        }
        if free.contains(&entering) {
            refused.clear();
        } else {
            refused.push(entering);
        }
    }
    Some(x)
}

/// Steps from x towards `wanted` in the free variables, as far as none becomes negative. Those that reach 0 are fixed there.
/// Returns true if it went all the way.
fn step(x: &mut [f64], free: &mut Vec<usize>, wanted: &[f64]) -> bool {
    let reach =
        |(&i, &wanted): (&usize, &f64)| (wanted <= 0.0).then(|| (i, x[i] / (x[i] - wanted).max(f64::MIN_POSITIVE)));
    let nearest = free
        .iter()
        .zip(wanted)
        .filter_map(reach)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let share = nearest.map_or(1.0, |(_, share)| share);
    for (&i, wanted) in free.iter().zip(wanted) {
        x[i] += share * (wanted - x[i]);
    }
    let Some((stopped, _)) = nearest else {
        return true;
    };
    x[stopped] = 0.0;
    free.retain(|&i| x[i] > 0.0);
    (0..x.len()).filter(|i| !free.contains(i)).for_each(|i| x[i] = 0.0);
    false
}

/// The minimum over the free variables with the others at 0, by Cholesky factorisation.
fn minimum(gram: &[Vec<f64>], right: &[f64], free: &[usize]) -> Option<Vec<f64>> {
    let count = free.len();
    let mut lower = vec![vec![0.0; count]; count];
    let mut solution: Vec<f64> = free.iter().map(|&i| right[i]).collect();
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = gram[free[i]][free[j]] - known;
            lower[i][j] = if i == j { rest.sqrt() } else { rest / lower[j][j] };
        }
        let known: f64 = (0..i).map(|k| lower[i][k] * solution[k]).sum();
        solution[i] = (solution[i] - known) / lower[i][i];
    }
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| lower[k][i] * solution[k]).sum();
        solution[i] = (solution[i] - known) / lower[i][i];
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The normal equations of `rows` × `count` numbers of which columns resemble each other, and of as many values.
    fn problem(rows: usize, count: usize, seed: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
        let number = |i: usize| ((i * (i + 31 * seed) + seed) as f64 * 0.754_877_666).fract();
        let row = |r: usize| -> Vec<f64> { (0..count).map(|c| number(r * count + c)).collect() };
        let matrix: Vec<Vec<f64>> = (0..rows).map(row).collect();
        let values: Vec<f64> = (0..rows).map(|r| number(7919 + r)).collect();
        let product = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| (0..rows).map(|r| a(r) * b(r)).sum::<f64>();
        let gram = |i: usize| {
            (0..count)
                .map(|j| product(&|r| matrix[r][i], &|r| matrix[r][j]))
                .collect()
        };
        let right = (0..count).map(|i| product(&|r| matrix[r][i], &|r| values[r]));
        ((0..count).map(gram).collect(), right.collect())
    }

    fn cost(gram: &[Vec<f64>], right: &[f64], x: &[f64]) -> f64 {
        let dot = |a: &[f64]| a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        let product: Vec<f64> = gram.iter().map(|row| dot(row)).collect();
        0.5 * dot(&product) - dot(right)
    }

    /// Karush, Kuhn and Tucker: no component is negative, none that is 0 would gain by growing, and the others would not
    /// gain by any change.
    fn assert_optimal(gram: &[Vec<f64>], right: &[f64], x: &[f64]) {
        for (i, (row, right)) in gram.iter().zip(right).enumerate() {
            let gain = right - row.iter().zip(x).map(|(g, x)| g * x).sum::<f64>();
            assert!(x[i] >= 0.0 && gain < 1e-10, "{i}: {} gains {gain}", x[i]);
            assert!(x[i] == 0.0 || gain > -1e-10, "{i}: {} loses {gain}", x[i]);
        }
    }

    #[test]
    fn solutions_meet_the_conditions_of_optimality() {
        let mut at_zero = 0;
        for seed in 1..40 {
            let (gram, right) = problem(60, 23, seed);
            let x = non_negative(&gram, &right).expect("a solution");
            assert_optimal(&gram, &right, &x);
            at_zero += x.iter().filter(|x| **x == 0.0).count();
        }
        assert!((100..800).contains(&at_zero), "{at_zero} of 897 are 0");
    }

    #[test]
    fn no_choice_of_free_variables_does_better() {
        for seed in 1..20 {
            let (gram, right) = problem(9, 6, seed);
            let found = cost(&gram, &right, &non_negative(&gram, &right).expect("a solution"));
            for set in 1..64 {
                let free: Vec<usize> = (0..6).filter(|i| (set >> i) & 1 == 1).collect();
                let mut x = vec![0.0; 6];
                let part = minimum(&gram, &right, &free).expect("a minimum");
                free.iter().zip(&part).for_each(|(&i, part)| x[i] = *part);
                let is_allowed = part.iter().all(|x| *x >= 0.0);
                assert!(
                    !is_allowed || cost(&gram, &right, &x) > found - 1e-12,
                    "seed {seed}: {free:?}"
                );
            }
        }
    }

    #[test]
    fn equal_columns_end_and_what_is_no_number_has_no_solution() {
        let (mut gram, mut right) = problem(40, 8, 3);
        // The last column again, but for what keeps the factors real.
        gram.iter_mut().for_each(|row| row.push(row[7]));
        gram.push(gram[7].clone());
        right.push(right[7]);
        (0..9).for_each(|i| gram[i][i] += 1e-10);
        let x = non_negative(&gram, &right).expect("a solution");
        assert_optimal(&gram, &right, &x);
        right[2] = f64::NAN;
        assert_eq!(non_negative(&gram, &right), None);
    }
}
