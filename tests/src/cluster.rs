//! Which particles hang together.

/// Number of points in each cluster of `points`, largest first. Two points belong together that are at most `reach`
/// apart, directly or by way of others.
pub fn sizes(points: &[[f64; 2]], reach: f64) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..points.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]));
    for (k, &i) in order.iter().enumerate() {
        for &j in order[k + 1..].iter().take_while(|&&j| points[j][0] - points[i][0] <= reach) {
            let [dx, dy] = [0, 1].map(|d| points[j][d] - points[i][d]);
            if dx * dx + dy * dy <= reach * reach {
                let (a, b) = (root(&mut parent, i), root(&mut parent, j));
                parent[a] = b;
            }
        }
    }
    let mut count = vec![0; points.len()];
    for i in 0..points.len() {
        count[root(&mut parent, i)] += 1;
    }
    count.retain(|&n| n > 0);
    count.sort_unstable_by(|a, b| b.cmp(a));
    count
}

#[cfg(test)]
mod tests {
    use super::sizes;

    #[test]
    fn chains_hang_together_and_gaps_part() {
        let chain = |from: f64, n: usize| (0..n).map(move |k| [from + k as f64, 0.5 * (k % 2) as f64]);
        let points: Vec<_> = chain(0.0, 7).chain(chain(7.9, 4)).chain([[3.0, 9.0]]).collect();
        assert_eq!(sizes(&points, 1.2), [7, 4, 1]);
        assert_eq!(sizes(&points, 2.0), [11, 1]);
        assert_eq!(sizes(&[], 1.0), [0; 0]);
    }
}
