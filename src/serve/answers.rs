//! The memory of answers that clients have not read yet.
//!
//! A client that asks and never reads keeps its answer in memory, and thousands of them would fill it. So a long answer
//! takes its size from a fixed amount before it is computed, and gives it back when its last byte is with the system.
//! Where nothing is left the request waits, and slow readers lose theirs. Short answers take nothing: the number of
//! connections bounds them.

use std::future::Future;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::response::Response;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::clients::{Clients, Connection, HeldResource};

/// The unit of the amount, in bytes.
const UNIT: usize = 64 << 10;

/// The amount, in units: 48 MiB, three of the longest usual answers (profiles of 100,000 stations). More would let idlers
/// hold more, less would let a few slow readers hold up the rest.
const UNITS: usize = 768;

/// The units that one client may hold; a longer answer takes no more than these.
pub const UNITS_OF_CLIENT: usize = UNITS / 2;

/// How often it is looked for a slow reader while an answer waits.
const RECHECK: Duration = Duration::from_millis(100);

/// The memory that is left for answers.
#[derive(Debug)]
pub struct AnswerMemory {
    units: Arc<Semaphore>,
}

/// Memory for one answer.
#[derive(Debug)]
pub struct AnswerPermit {
    own: OwnedSemaphorePermit,
    all: OwnedSemaphorePermit,
    connection: Arc<Connection>,
}

/// Bytes of an answer with the permit for their memory.
struct HeldAnswer {
    bytes: Bytes,
    _permit: AnswerPermit,
}

impl AsRef<[u8]> for HeldAnswer {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

impl Drop for AnswerPermit {
    fn drop(&mut self) {
        self.connection.hold(None);
    }
}

impl Default for AnswerMemory {
    fn default() -> Self {
        Self { units: Arc::new(Semaphore::new(UNITS)) }
    }
}

impl AnswerMemory {
    /// Waits for memory for an answer of at most `bytes`.
    pub async fn reserve(
        &self,
        clients: &Clients,
        connection: &Arc<Connection>,
        bytes: usize,
    ) -> AnswerPermit {
        let units = units(bytes);
        let own = acquire(&connection.client.answers, units).await;
        let all = taking_from_slow(clients, HeldResource::Answer, acquire(&self.units, units)).await;
        AnswerPermit { own, all, connection: Arc::clone(connection) }
    }
}

/// Awaits `resource`, and meanwhile closes slow connections that hold one like it.
pub async fn taking_from_slow<T>(
    clients: &Clients,
    kind: HeldResource,
    resource: impl Future<Output = T>,
) -> T {
    let mut resource = pin!(resource);
    loop {
        tokio::select! {
            taken = &mut resource => return taken,
            () = tokio::time::sleep(RECHECK) => clients.close_slowest(kind),
        }
    }
}

async fn acquire(semaphore: &Arc<Semaphore>, units: u32) -> OwnedSemaphorePermit {
    let permit = Arc::clone(semaphore).acquire_many_owned(units).await;
    permit.expect("no semaphore of the service is ever closed")
}

fn units(bytes: usize) -> u32 {
    bytes.div_ceil(UNIT).min(UNITS_OF_CLIENT) as u32
}

/// The response, whose body holds what it needs of `permit` until it is sent; the rest is given back.
pub async fn hold(response: Response, mut permit: AnswerPermit) -> Response {
    let (parts, body) = response.into_parts();
    // A body that is made of memory, as all here, is neither copied nor waited for, and does not fail.
    let bytes = to_bytes(body, usize::MAX).await.unwrap_or_default();
    let spare = permit.all.num_permits().saturating_sub(units(bytes.len()) as usize);
    drop((permit.own.split(spare), permit.all.split(spare)));
    permit.connection.hold(Some(HeldResource::Answer));
    Response::from_parts(parts, Body::from(Bytes::from_owner(HeldAnswer { bytes, _permit: permit })))
}
