//! What the transport's errors mean for the handshake, matched by value: a variant that is renamed upstream does not
//! compile.

use iceoryx2::port::listener::ListenerCreateError;
use iceoryx2::port::notifier::NotifierCreateError;
use iceoryx2::port::publisher::PublisherCreateError;
use iceoryx2::port::subscriber::SubscriberCreateError;
use iceoryx2::service::builder::event::{EventCreateError, EventOpenError, EventOpenOrCreateError};
use iceoryx2::service::builder::publish_subscribe::{
    PublishSubscribeCreateError, PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use std::fmt::Debug;

/// What to do about a service that could not be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The other side means something else by this service.
    Incompatible,
    /// All places are taken.
    Taken,
    /// The system does not allow it.
    Refused,
    /// Somebody else creates, opens or removes the service at the same time: try again.
    Race,
}

/// Why a service could not be opened or created.
pub(super) trait OpenError: Debug {
    /// Meaning of the error.
    fn verdict(&self) -> Verdict;
}

impl OpenError for PublishSubscribeOpenOrCreateError {
    fn verdict(&self) -> Verdict {
        use PublishSubscribeOpenError as Open;
        match self {
            Self::PublishSubscribeOpenError(error) => match error {
                Open::IncompatibleTypes
                | Open::IncompatibleMessagingPattern
                | Open::IncompatibleAttributes
                | Open::IncompatibleOverflowBehavior
                | Open::DoesNotSupportRequestedMinBufferSize
                | Open::DoesNotSupportRequestedMinHistorySize
                | Open::DoesNotSupportRequestedMinSubscriberBorrowedSamples
                | Open::DoesNotSupportRequestedAmountOfPublishers
                | Open::DoesNotSupportRequestedAmountOfSubscribers
                | Open::DoesNotSupportRequestedAmountOfNodes
                | Open::VersionMismatch => Verdict::Incompatible,
                Open::ExceedsMaxNumberOfNodes => Verdict::Taken,
                Open::InsufficientPermissions => Verdict::Refused,
                _ => Verdict::Race,
            },
            Self::PublishSubscribeCreateError(PublishSubscribeCreateError::InsufficientPermissions) => {
                Verdict::Refused
            }
            _ => Verdict::Race,
        }
    }
}

impl OpenError for EventOpenOrCreateError {
    fn verdict(&self) -> Verdict {
        use EventOpenError as Open;
        match self {
            Self::EventOpenError(error) => match error {
                Open::IncompatibleMessagingPattern
                | Open::IncompatibleAttributes
                | Open::IncompatibleDeadline
                | Open::IncompatibleNotifierCreatedEvent
                | Open::IncompatibleNotifierDroppedEvent
                | Open::IncompatibleNotifierDeadEvent
                | Open::DoesNotSupportRequestedAmountOfNotifiers
                | Open::DoesNotSupportRequestedAmountOfListeners
                | Open::DoesNotSupportRequestedMaxEventId
                | Open::DoesNotSupportRequestedAmountOfNodes
                | Open::VersionMismatch => Verdict::Incompatible,
                Open::ExceedsMaxNumberOfNodes => Verdict::Taken,
                Open::InsufficientPermissions => Verdict::Refused,
                _ => Verdict::Race,
            },
            Self::EventCreateError(EventCreateError::InsufficientPermissions) => Verdict::Refused,
            _ => Verdict::Race,
        }
    }
}

/// Why a port could not be made.
pub(super) trait PortError: Debug {
    /// Somebody else has the only place.
    fn is_taken(&self) -> bool;
}

impl PortError for PublisherCreateError {
    fn is_taken(&self) -> bool {
        matches!(self, Self::ExceedsMaxSupportedPublishers)
    }
}

impl PortError for SubscriberCreateError {
    fn is_taken(&self) -> bool {
        matches!(self, Self::ExceedsMaxSupportedSubscribers)
    }
}

impl PortError for ListenerCreateError {
    fn is_taken(&self) -> bool {
        matches!(self, Self::ExceedsMaxSupportedListeners)
    }
}

impl PortError for NotifierCreateError {
    fn is_taken(&self) -> bool {
        matches!(self, Self::ExceedsMaxSupportedNotifiers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_transport_are_told_apart_by_value() {
        let open = PublishSubscribeOpenOrCreateError::PublishSubscribeOpenError;
        let wake = EventOpenOrCreateError::EventOpenError;
        for (verdict, expected) in [
            (open(PublishSubscribeOpenError::ExceedsMaxNumberOfNodes).verdict(), Verdict::Taken),
            (open(PublishSubscribeOpenError::IncompatibleTypes).verdict(), Verdict::Incompatible),
            (open(PublishSubscribeOpenError::IsMarkedForDestruction).verdict(), Verdict::Race),
            (PublishSubscribeOpenOrCreateError::SystemInFlux.verdict(), Verdict::Race),
            (wake(EventOpenError::ExceedsMaxNumberOfNodes).verdict(), Verdict::Taken),
            (wake(EventOpenError::DoesNotSupportRequestedAmountOfNotifiers).verdict(), Verdict::Incompatible),
            (wake(EventOpenError::InsufficientPermissions).verdict(), Verdict::Refused),
        ] {
            assert_eq!(verdict, expected);
        }
        assert!(PublisherCreateError::ExceedsMaxSupportedPublishers.is_taken());
        assert!(!PublisherCreateError::UnableToCreatePortTag.is_taken());
    }
}
