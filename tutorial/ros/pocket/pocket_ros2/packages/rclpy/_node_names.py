"""A node's own name, and how the node resolves topic names."""

from rclpy import _names
from rclpy._arguments import Arguments
from rclpy._rclpy_pybind11 import Destroyable, RCLError


class NodeNames(Destroyable):
    """The part of a node that handles names. Its methods raise InvalidHandle once the node is destroyed."""

    def _init_names(self, name: str, namespace: str, arguments: list[Arguments]) -> None:
        """Apply remappings to the node's own name and namespace, and check both."""
        _names.validate_node_name(name)
        self._arguments = arguments
        self._name, self._namespace = name, namespace if namespace.startswith("/") else f"/{namespace}"
        for given in reversed(arguments):
            self._name = given.node_value(name, "__node") or self._name
            self._namespace = given.node_value(name, "__ns") or self._namespace
        _names.validate_node_name(self._name)
        _names.validate_namespace(self._namespace)

    def get_name(self) -> str:
        """Return the node's name."""
        self._require_handle()
        return self._name

    def get_namespace(self) -> str:
        """Return the node's namespace, which begins with a slash."""
        self._require_handle()
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Return the node's full name, which includes the namespace."""
        self._require_handle()
        return self._full_name()

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic's full name, remapped unless ``only_expand`` is true.

        Raises:
            RCLError: the name breaks the naming rules.
        """
        self._require_handle()
        try:
            name = _names.expand_topic_name(topic, self._name, self._namespace)
        except ValueError as error:
            raise RCLError(f"failed to resolve name: {str(error).partition(' is invalid: ')[2]}") from None
        name = name if only_expand else self._remapped(name)
        if found := _names.problem(_names.FULL_TOPIC_NAME, name):
            raise RCLError(f"failed to resolve name: {found[0]}")
        return name

    def _expanded(self, topic_name: str) -> str:
        """Return a topic's full name without remapping it.

        Raises:
            ValueError: the name cannot be expanded.
            InvalidTopicNameException: the expanded name breaks the naming rules.
        """
        full_name = _names.expand_topic_name(topic_name, self.get_name(), self.get_namespace())
        _names.validate_full_topic_name(full_name)
        return full_name

    def _full_name(self) -> str:
        return f"{self._namespace.rstrip('/')}/{self._name}"

    def _remapped(self, full_name: str) -> str:
        found = (arguments.topic(full_name, self._name, self._namespace) for arguments in self._arguments)
        return next((name for name in found if name is not None), full_name)
