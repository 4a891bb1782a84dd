//! Small dense linear algebra on column-major slices, written for tall matrices of few columns.

/// Σ aᵢbᵢ over eight interleaved partial sums, whose order is fixed and which the compiler can vectorise.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (a_blocks, b_blocks) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = a_blocks.remainder().iter().zip(b_blocks.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a_blocks.zip(b_blocks) {
        for lane in 0..8 {
            lanes[lane] += x[lane] * y[lane];
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (b + f)) + ((c + g) + (d + h)) + tail
}

/// Turns `matrix` (rows × columns, rows ≥ columns) into the triangle R of its QR factorisation and `right` into Qᵀ·right,
/// by Householder reflections (Golub & Van Loan 2013, algorithm 5.2.1).
///
/// R stands in the upper triangle, the reflections below it, and their first components are returned: what
/// [`reflect`] needs to apply Qᵀ once more. A column without any length gives a zero on the
/// diagonal. Backward stable: the error is that of a change of each column by a few units of rounding.
pub(super) fn triangularise(matrix: &mut [f64], rows: usize, right: &mut [f64]) -> Vec<f64> {
    debug_assert!(rows > 0 && matrix.len().is_multiple_of(rows) && right.len() == rows, "shapes must agree");
    let columns = matrix.len() / rows;
    debug_assert!(columns <= rows, "a wide matrix has no triangle");
    let mut heads = vec![0.0; columns];
    for k in 0..columns {
        let (head, rest) = matrix[k * rows..].split_at_mut(rows);
        let v = &mut head[k..];
        let length = dot(v, v).sqrt();
        // Shorter than this its square is no longer a normal number.
        if length < 1e-150 {
            continue;
        }
        // The sign that avoids cancellation in the first component.
        let diagonal = -length.copysign(v[0]);
        v[0] -= diagonal;
        heads[k] = v[0];
        let factor = 1.0 / (diagonal * v[0]);
        let others = rest.chunks_exact_mut(rows).map(|column| &mut column[k..]);
        for column in others.chain(std::iter::once(&mut right[k..])) {
            add(column, factor * dot(v, column), v);
        }
        v[0] = diagonal;
    }
    heads
}

/// Turns `right` into Qᵀ·right, for a matrix that [`triangularise`] has factorised with these heads.
pub(super) fn reflect(matrix: &[f64], rows: usize, heads: &[f64], right: &mut [f64]) {
    for (k, &head) in heads.iter().enumerate().filter(|head| *head.1 != 0.0) {
        let column = &matrix[k * rows + k..(k + 1) * rows];
        let right = &mut right[k..];
        let shift = (head * right[0] + dot(&column[1..], &right[1..])) / (column[0] * head);
        right[0] += shift * head;
        add(&mut right[1..], shift, &column[1..]);
    }
}

/// target += factor · direction.
fn add(target: &mut [f64], factor: f64, direction: &[f64]) {
    for (value, direction) in target.iter_mut().zip(direction) {
        *value += factor * direction;
    }
}

/// Solves R·x = right for the upper triangle left by [`triangularise`]. A zero on the diagonal gives a zero in x.
pub(super) fn back_substitute(triangle: &[f64], rows: usize, right: &[f64], x: &mut [f64]) {
    for k in (0..x.len()).rev() {
        let sum = (k + 1..x.len()).fold(right[k], |sum, j| sum - triangle[j * rows + k] * x[j]);
        let diagonal = triangle[k * rows + k];
        x[k] = if diagonal == 0.0 { 0.0 } else { sum / diagonal };
    }
}
