//! The transportation problem: what goes where at the least cost, exactly (Hitchcock 1941).
//!
//! Amounts go along cheapest paths, one after the other, each found by Dijkstra's algorithm on costs that potentials keep
//! from being negative (Edmonds and Karp 1972): after each path the plan is the cheapest of its amount. All numbers are whole,
//! so that sums are exact; equal costs are decided by the order of sources and sinks.

use sandtable_terrain::stop_flag::StopFlag;

/// An amount that goes from a source to a sink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shipment {
    pub source: usize,
    pub sink: usize,
    pub amount: u64,
}

/// The costs of a unit from each source to each sink, source by source.
pub(crate) struct TransportCosts {
    pub of_unit: Vec<u32>,
    pub sinks: usize,
}

/// The cheapest plan that moves as much as supplies and demands allow, by source and sink; `None` where it was stopped.
pub(crate) fn cheapest_plan(
    supplies: &[u64],
    demands: &[u64],
    costs: &TransportCosts,
    stop: &StopFlag,
) -> Option<Vec<Shipment>> {
    let mut plan = TransportPlan::new(supplies, demands, costs);
    while plan.ship_along_cheapest_path() {
        if stop.is_stopped() {
            return None;
        }
    }
    let shipments = plan.flows.iter().enumerate().filter(|(_, amount)| **amount > 0);
    Some(
        shipments
            .map(|(arc, &amount)| Shipment { source: arc / costs.sinks, sink: arc % costs.sinks, amount })
            .collect(),
    )
}

const UNREACHED: i64 = i64::MAX;

/// Nodes are the sources, then the sinks.
struct TransportPlan<'a> {
    costs: &'a TransportCosts,
    supplies: Vec<u64>,
    demands: Vec<u64>,
    /// As the costs.
    flows: Vec<u64>,
    potentials: Vec<i64>,
    distances: Vec<i64>,
    before: Vec<usize>,
    is_settled: Vec<bool>,
}

impl<'a> TransportPlan<'a> {
    fn new(supplies: &[u64], demands: &[u64], costs: &'a TransportCosts) -> Self {
        let nodes = supplies.len() + demands.len();
        Self {
            costs,
            supplies: supplies.to_vec(),
            demands: demands.to_vec(),
            flows: vec![0; costs.of_unit.len()],
            potentials: vec![0; nodes],
            distances: vec![UNREACHED; nodes],
            before: vec![0; nodes],
            is_settled: vec![false; nodes],
        }
    }

    /// Ships what fits along the cheapest path from any supply to any demand; false where there is none.
    fn ship_along_cheapest_path(&mut self) -> bool {
        let sources = self.supplies.len();
        let Some(end) = self.find_path() else { return false };
        let mut amount = self.demands[end - sources];
        let mut at = end;
        loop {
            let source = self.before[at];
            if source >= sources {
                // A sink before a source: what it gets from there can be less.
                amount = amount.min(self.flows[at * self.costs.sinks + source - sources]);
            } else if source == at {
                amount = amount.min(self.supplies[at]);
                break;
            }
            at = source;
        }
        self.demands[end - sources] -= amount;
        let mut at = end;
        loop {
            let before = self.before[at];
            if before == at {
                self.supplies[at] -= amount;
                return true;
            }
            if before < sources {
                self.flows[before * self.costs.sinks + at - sources] += amount;
            } else {
                self.flows[at * self.costs.sinks + before - sources] -= amount;
            }
            at = before;
        }
    }

    /// The nearest node with a demand; `before` leads back to a source, which is before itself.
    fn find_path(&mut self) -> Option<usize> {
        let (sources, sinks) = (self.supplies.len(), self.demands.len());
        self.distances.fill(UNREACHED);
        self.is_settled.fill(false);
        for source in (0..sources).filter(|&source| self.supplies[source] > 0) {
            // Its potential is 0 as long as it has a supply: no path leads to it at a lower cost than none.
            self.distances[source] = -self.potentials[source];
            self.before[source] = source;
        }
        loop {
            let open = (0..sources + sinks).filter(|&node| !self.is_settled[node]);
            let at = open.min_by_key(|&node| self.distances[node])?;
            let distance = self.distances[at];
            if distance == UNREACHED {
                return None;
            }
            self.is_settled[at] = true;
            if at >= sources && self.demands[at - sources] > 0 {
                for node in 0..sources + sinks {
                    self.potentials[node] += self.distances[node].min(distance);
                }
                return Some(at);
            }
            if at < sources {
                for sink in 0..sinks {
                    let cost = i64::from(self.costs.of_unit[at * sinks + sink]);
                    self.reach(sources + sink, at, cost);
                }
            } else {
                for source in 0..sources {
                    let arc = source * sinks + at - sources;
                    if self.flows[arc] > 0 {
                        self.reach(source, at, -i64::from(self.costs.of_unit[arc]));
                    }
                }
            }
        }
    }

    fn reach(&mut self, node: usize, from: usize, cost: i64) {
        let distance = self.distances[from] + cost + self.potentials[from] - self.potentials[node];
        if !self.is_settled[node] && distance < self.distances[node] {
            self.distances[node] = distance;
            self.before[node] = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::random;

    fn cost(plan: &[Shipment], costs: &TransportCosts) -> u64 {
        plan.iter()
            .map(|part| part.amount * u64::from(costs.of_unit[part.source * costs.sinks + part.sink]))
            .sum()
    }

    #[test]
    fn the_plan_is_that_of_a_textbook() {
        // Hillier and Lieberman's canneries: shipping costs 152,535 in hundreds of dollars at the best.
        let of_unit = vec![464, 513, 654, 867, 352, 416, 690, 791, 995, 682, 388, 685];
        let costs = TransportCosts { of_unit, sinks: 4 };
        let plan = cheapest_plan(&[75, 125, 100], &[80, 65, 70, 85], &costs, &StopFlag::default());
        assert_eq!(cost(&plan.expect("not stopped"), &costs), 152_535);
    }

    /// The least cost of all plans, unit by unit.
    fn brute(supplies: &mut [u64], demands: &mut [u64], costs: &TransportCosts, units: u64) -> u64 {
        if units == 0 {
            return 0;
        }
        // The next unit leaves the first source that is still to give; leaving it for good is the other way.
        let Some(source) = supplies.iter().position(|&supply| supply > 0) else { return u64::MAX };
        let mut best = u64::MAX;
        for sink in 0..demands.len() {
            if demands[sink] > 0 {
                supplies[source] -= 1;
                demands[sink] -= 1;
                let rest = brute(supplies, demands, costs, units - 1);
                best = best.min(rest.saturating_add(u64::from(costs.of_unit[source * costs.sinks + sink])));
                supplies[source] += 1;
                demands[sink] += 1;
            }
        }
        if supplies.iter().sum::<u64>() > units {
            supplies[source] -= 1;
            best = best.min(brute(supplies, demands, costs, units));
            supplies[source] += 1;
        }
        best
    }

    #[test]
    fn plans_cost_the_least_of_all_plans_whichever_side_has_more() {
        let mut bits = random(7);
        let mut random = |below: u64| bits() % below;
        for _ in 0..300 {
            let (sources, sinks) = (1 + random(3) as usize, 1 + random(3) as usize);
            let mut supplies: Vec<u64> = (0..sources).map(|_| random(4)).collect();
            let mut demands: Vec<u64> = (0..sinks).map(|_| random(4)).collect();
            let of_unit = (0..sources * sinks).map(|_| random(20) as u32).collect();
            let costs = TransportCosts { of_unit, sinks };
            let plan = cheapest_plan(&supplies, &demands, &costs, &StopFlag::default()).expect("not stopped");
            let units = supplies.iter().sum::<u64>().min(demands.iter().sum());
            assert_eq!(plan.iter().map(|part| part.amount).sum::<u64>(), units);
            for (source, &supply) in supplies.iter().enumerate() {
                let sent = plan.iter().filter(|part| part.source == source).map(|part| part.amount);
                assert!(sent.sum::<u64>() <= supply);
            }
            assert_eq!(cost(&plan, &costs), brute(&mut supplies, &mut demands, &costs, units));
        }
    }
}
