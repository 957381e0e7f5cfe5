//! The stores behind addresses: they sign requests with credentials from the standard environment variables, and send
//! unsigned ones without.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey};
use object_store::azure::{AzureConfigKey, MicrosoftAzureBuilder};
use object_store::gcp::{GoogleCloudStorageBuilder, GoogleConfigKey};
use object_store::http::HttpBuilder;
use object_store::path::Path;
use object_store::{BackoffConfig, ClientConfigKey, ObjectStore, RetryConfig};

use crate::access::RemoteAccess;
use crate::address::{AddressScheme, AllowedHost, RemoteAddress};
use crate::error::RemoteError;
use crate::http_client::GuardedConnector;
use crate::request_error::{cause, plain};
use crate::times::RemoteTimes;

/// Tries after the first of a request: half a second to some seconds apart.
const RETRIES: usize = 4;

/// The hosts that give credentials to programs on machines of a cloud: they are asked where they are allowed.
const METADATA_HOSTS: [&str; 3] = ["169.254.169.254", "169.254.170.2", "metadata.google.internal"];

/// A file in a store.
#[derive(Clone, Debug)]
pub(crate) struct StoredFile {
    /// The server.
    pub store: Arc<dyn ObjectStore>,
    /// Its name there.
    pub path: Path,
    /// How long the server is waited for.
    pub times: RemoteTimes,
}

/// What a store is made with: others may read from other hosts.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StoreKey {
    scheme: AddressScheme,
    authority: String,
    hosts: Vec<AllowedHost>,
    times: RemoteTimes,
}

impl StoredFile {
    /// The file at an address. Stores are made once, so that their connections are used again.
    ///
    /// # Errors
    /// The host is not allowed, or the variables of credentials contradict each other.
    pub fn at(
        address: &RemoteAddress,
        access: &RemoteAccess,
        times: RemoteTimes,
    ) -> Result<Self, RemoteError> {
        static STORES: Mutex<BTreeMap<StoreKey, Arc<dyn ObjectStore>>> = Mutex::new(BTreeMap::new());
        // Before anything of the environment is looked at.
        if let Some(host) = address.host().filter(|host| !access.allows(host)) {
            return Err(RemoteError::HostNotAllowed(host));
        }
        let path = match address.scheme.is_web() {
            true => Path::from_url_path(&address.path),
            false => Path::parse(&address.path),
        };
        let path = path.map_err(|_| RemoteError::Address("its path is none of a file"))?;
        let (scheme, authority) = (address.scheme, address.authority.clone());
        let key = StoreKey { scheme, authority, hosts: access.hosts.clone(), times };
        let mut stores = STORES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(store) = stores.get(&key) {
            return Ok(Self { store: Arc::clone(store), path, times });
        }
        let store = new_store(address, access, times).map_err(|error| store_error(&error))?;
        stores.insert(key, Arc::clone(&store));
        Ok(Self { store, path, times })
    }
}

/// The error of a store: what this program refuses, else what it says.
pub(crate) fn store_error(error: &object_store::Error) -> RemoteError {
    if let Some(own) = cause(error) {
        return own;
    }
    match error {
        object_store::Error::NotFound { .. } => RemoteError::Missing,
        object_store::Error::Precondition { .. } => RemoteError::Changed,
        object_store::Error::PermissionDenied { source, .. }
        | object_store::Error::Unauthenticated { source, .. } => {
            RemoteError::Denied(plain(&source.to_string()))
        }
        error => RemoteError::Store(plain(&error.to_string())),
    }
}

fn new_store(
    address: &RemoteAddress,
    access: &RemoteAccess,
    times: RemoteTimes,
) -> Result<Arc<dyn ObjectStore>, object_store::Error> {
    let connector = GuardedConnector { access: access.clone(), times };
    let backoff = BackoffConfig {
        init_backoff: Duration::from_millis(200),
        max_backoff: Duration::from_secs(4),
        base: 2.0,
    };
    let retry = RetryConfig { backoff, max_retries: RETRIES, retry_timeout: times.retry };
    // Who gives credentials to all programs of a machine is not asked unless that is allowed.
    let is_anonymous = !METADATA_HOSTS.iter().any(|host| access.allows(host));
    let name = &address.authority;
    Ok(match address.scheme {
        AddressScheme::Http | AddressScheme::Https => {
            let is_plain = address.scheme == AddressScheme::Http;
            let scheme = if is_plain { "http" } else { "https" };
            let builder = HttpBuilder::new().with_url(format!("{scheme}://{name}"));
            let builder = builder.with_config(ClientConfigKey::AllowHttp, is_plain.to_string());
            Arc::new(builder.with_retry(retry).with_http_connector(connector).build()?)
        }
        AddressScheme::S3 => {
            let mut builder = AmazonS3Builder::from_env().with_bucket_name(name);
            let is_stated = |key| builder.get_config_value(&key).is_some();
            let is_signed = is_stated(AmazonS3ConfigKey::AccessKeyId)
                || is_stated(AmazonS3ConfigKey::SecretAccessKey)
                || is_stated(AmazonS3ConfigKey::WebIdentityTokenFile)
                || is_stated(AmazonS3ConfigKey::ContainerCredentialsRelativeUri)
                || is_stated(AmazonS3ConfigKey::ContainerCredentialsFullUri);
            if is_anonymous && !is_signed {
                builder = builder.with_skip_signature(true);
            }
            Arc::new(builder.with_retry(retry).with_http_connector(connector).build()?)
        }
        AddressScheme::Gs => {
            let mut builder = GoogleCloudStorageBuilder::from_env().with_bucket_name(name);
            let is_stated = |key| builder.get_config_value(&key).is_some();
            let is_signed = is_stated(GoogleConfigKey::ServiceAccount)
                || is_stated(GoogleConfigKey::ServiceAccountKey)
                || is_stated(GoogleConfigKey::ApplicationCredentials)
                || is_stated(GoogleConfigKey::BearerToken);
            if is_anonymous && !is_signed {
                builder = builder.with_skip_signature(true);
            }
            Arc::new(builder.with_retry(retry).with_http_connector(connector).build()?)
        }
        AddressScheme::Az => {
            let mut builder = MicrosoftAzureBuilder::from_env().with_container_name(name);
            let is_stated = |key| builder.get_config_value(&key).is_some();
            // An emulator has an account with a key that all know.
            let emulator = builder.get_config_value(&AzureConfigKey::UseEmulator);
            let is_yes =
                |value: String| matches!(&*value.to_ascii_lowercase(), "1" | "true" | "on" | "yes" | "y");
            let is_emulator = emulator.is_some_and(is_yes);
            let is_signed = is_stated(AzureConfigKey::AccessKey)
                || is_stated(AzureConfigKey::SasKey)
                || is_stated(AzureConfigKey::Token)
                || is_stated(AzureConfigKey::ClientSecret)
                || is_stated(AzureConfigKey::FederatedTokenFile)
                || is_emulator;
            if is_anonymous && !is_signed {
                builder = builder.with_skip_signature(true);
            }
            Arc::new(builder.with_retry(retry).with_http_connector(connector).build()?)
        }
    })
}
