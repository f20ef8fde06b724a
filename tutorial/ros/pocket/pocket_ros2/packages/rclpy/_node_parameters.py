"""A node's own parameters. Other nodes cannot access them, because the pocket ROS 2 has no services."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rcl_interfaces.msg import (
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMessage
from rclpy import exceptions
from rclpy._arguments import Arguments
from rclpy._parameter_rules import TOLERANCE, is_listed, read_declaration, refusal
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

PreSetCallback = Callable[[list[Parameter]], list[Parameter]]
OnSetCallback = Callable[[list[Parameter]], SetParametersResult]
PostSetCallback = Callable[[list[Parameter]], None]

TYPE_SERVICE = "start_type_description_service"
"""A parameter that every rclpy node has. It has no effect here: the pocket ROS 2 has no services."""

EMPTIED = (
    "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying the original "
    "parameters list."
)


class NodeParameters:
    """The part of a node that handles parameters.

    Each change is published on ``/parameter_events``. Callbacks run in reverse order: the callback added last runs
    first.
    """

    PARAM_REL_TOL = TOLERANCE

    _use_sim_time: Callable[[bool], None]
    """Switches the node's clock to simulated time, or back to system time."""
    _publish_parameter_event: Callable[[ParameterEvent], None]

    def _init_parameters(
        self, name: str, arguments: list[Arguments], given: Iterable[Parameter], allow_undeclared: bool
    ) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, ParameterDescriptor] = {}
        self._overrides: dict[str, Any] = {}
        self._allow_undeclared = allow_undeclared
        self._pre_set: list[PreSetCallback] = []
        self._on_set: list[OnSetCallback] = []
        self._post_set: list[PostSetCallback] = []
        for source in reversed(arguments):
            self._overrides.update(source.overrides(name))
        self._overrides.update((parameter.name, parameter.value) for parameter in given)

    def _declare_first(self, from_overrides: bool) -> None:
        """Declare the parameters that every node has.

        Args:
            from_overrides: first declare the parameters in ``parameter_overrides`` and on the command line.
        """
        if from_overrides:
            given = [(name, value, ParameterDescriptor()) for name, value in self._overrides.items()]
            self.declare_parameters("", given, ignore_override=True)
        if not self.has_parameter("use_sim_time"):
            self.declare_parameter("use_sim_time", False)
        if not self.has_parameter(TYPE_SERVICE):
            description = "If enabled, start the ~/get_type_description service."
            self.declare_parameter(TYPE_SERVICE, True, ParameterDescriptor(description=description, read_only=True))

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: ParameterDescriptor | None = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter; a value on the command line takes precedence over ``value``.

        Args:
            name: the parameter's name.
            value: its value, or only its type.
            descriptor: describes which values are allowed, and whether the value can be changed.
            ignore_override: ignore the command line and ``parameter_overrides``.

        Raises:
            ParameterAlreadyDeclaredException: the parameter has already been declared.
            InvalidParameterTypeException: the value on the command line is of a different type.
            InvalidParameterValueException: the descriptor or a callback does not allow the value.
        """
        only_name = value is None and descriptor is None
        given = (name,) if only_name else (name, value, ParameterDescriptor() if descriptor is None else descriptor)
        return self._declare("", [given], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several parameters.

        Args:
            namespace: prefix of each name, separated from it by a dot unless the prefix is empty.
            parameters: a tuple for each parameter: its name, its value or type, and its descriptor. The last two
                elements are optional.
            ignore_override: ignore the command line and ``parameter_overrides``.

        Raises:
            TypeError: a tuple is too long or empty, or an element has the wrong type.
            ParameterAlreadyDeclaredException: a parameter has already been declared. In this case, the call declares
                nothing.
            InvalidParameterTypeException: the value on the command line is of a different type.
            InvalidParameterValueException: a descriptor or a callback rejects a value; the parameters before it have
                been declared.
        """
        return self._declare(namespace, parameters, ignore_override)

    def undeclare_parameter(self, name: str) -> None:
        """Remove a parameter.

        Raises:
            ParameterNotDeclaredException: the parameter has not been declared.
            ParameterImmutableException: the parameter is read-only.
        """
        if name not in self._parameters:
            raise exceptions.ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise exceptions.ParameterImmutableException(name)
        self._forget(name)

    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter has been declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter. If it is undeclared and undeclared parameters are allowed, the result has no value.

        Raises:
            ParameterNotDeclaredException: the parameter has not been declared.
            ParameterUninitializedException: the parameter has been declared with only a type, and has no value.
        """
        if name not in self._parameters:
            self._require_undeclared_allowed(name)
            return Parameter(name, Parameter.Type.NOT_SET)
        parameter = self._parameters[name]
        if parameter.type_ == Parameter.Type.NOT_SET and not self._descriptors[name].dynamic_typing:
            raise exceptions.ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Return several parameters; see :meth:`get_parameter`.

        Raises:
            TypeError: a name is not a string.
        """
        return [self.get_parameter(name) for name in _strings(names)]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or an alternative if the parameter has not been declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.type_ == Parameter.Type.NOT_SET:
            return Parameter(name, Parameter.Type.NOT_SET) if alternative_value is None else alternative_value
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters under a prefix, keyed by the rest of their names. An empty prefix matches any name."""
        start = prefix + PARAMETER_SEPARATOR_STRING if prefix else ""
        return {
            name.removeprefix(start): parameter
            for name, parameter in self._parameters.items()
            if name.startswith(start)
        }

    def get_parameter_type(self, name: str) -> Any:
        """Return a parameter's type as a number; see ``Parameter.Type``.

        Raises:
            ParameterNotDeclaredException: the parameter has not been declared.
        """
        if name in self._parameters:
            return self._parameters[name].type_.value
        self._require_undeclared_allowed(name)
        return Parameter.Type.NOT_SET  # as in rclpy, the enum member, not its number

    def get_parameter_types(self, names: Sequence[str]) -> list[Any]:
        """Return the types of several parameters; see :meth:`get_parameter_type`.

        Raises:
            TypeError: a name is not a string.
        """
        return [self.get_parameter_type(name) for name in _strings(names)]

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return a parameter's descriptor.

        Raises:
            ParameterNotDeclaredException: the parameter has not been declared.
        """
        if name not in self._descriptors:
            self._require_undeclared_allowed(name)
            return ParameterDescriptor()
        return self._descriptors[name]

    def describe_parameters(self, names: Sequence[str]) -> list[ParameterDescriptor]:
        """Return the descriptors of several parameters; see :meth:`describe_parameter`."""
        return [self.describe_parameter(name) for name in names]

    def list_parameters(self, prefixes: list[str], depth: int) -> ListParametersResult:
        """Return the names of parameters, and the prefixes of these names.

        Args:
            prefixes: list only these names and the names below them; an empty list means all names.
            depth: how many levels of names to list; 0 means all.

        Raises:
            TypeError: an argument is of the wrong type.
            ValueError: the depth is negative.
        """
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")
        names = [name for name in self._parameters if is_listed(name, prefixes, depth)]
        parents = (name.rpartition(PARAMETER_SEPARATOR_STRING)[0] for name in names)
        return ListParametersResult(names=names, prefixes=list(dict.fromkeys(filter(None, parents))))

    def set_descriptor(
        self, name: str, descriptor: ParameterDescriptor, alternative_value: ParameterValue | None = None
    ) -> ParameterValue:
        """Replace a parameter's descriptor, and return the parameter's value.

        Args:
            name: the parameter's name.
            descriptor: the new descriptor; the name in it is ignored.
            alternative_value: value to set if the new descriptor rejects the current value.

        Raises:
            ParameterNotDeclaredException: the parameter has not been declared.
            ParameterImmutableException: the parameter is read-only.
            InvalidParameterValueException: the descriptor rejects both the current and the alternative value.
        """
        parameter = self.get_parameter(name)
        if name not in self._parameters:
            return parameter.get_parameter_value()
        if self._descriptors[name].read_only:
            raise exceptions.ParameterImmutableException(name)
        if refusal(parameter, descriptor, is_declared=True):
            if alternative_value is not None:
                parameter = Parameter.from_parameter_msg(ParameterMessage(name=name, value=alternative_value))
            if reason := refusal(parameter, descriptor, is_declared=True):
                raise exceptions.InvalidParameterValueException(name, parameter.value, reason)
        self._parameters[name], self._descriptors[name] = parameter, descriptor
        return parameter.get_parameter_value()

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[SetParametersResult]:
        """Set parameters one by one; for each parameter, return whether it was set and, if not, why.

        Raises:
            ParameterNotDeclaredException: a parameter has not been declared; the parameters before it have been set.
        """
        return [self._set_all([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all the parameters, or none if one is rejected; return whether they were set and, if not, why.

        Setting a dynamically typed parameter to a parameter of type ``NOT_SET``, which has no value, undeclares it.

        Raises:
            ParameterNotDeclaredException: a parameter has not been declared.
        """
        return self._set_all(parameter_list)

    def add_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Add a callback that receives the list of parameters about to be set, and returns the list to set instead."""
        self._pre_set.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Add a callback that can reject parameters about to be set or declared."""
        self._on_set.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Add a callback that receives parameters after they have been set or declared."""
        self._post_set.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Remove a callback, or raise ValueError if it has not been added."""
        self._pre_set.remove(callback)

    def remove_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Remove a callback, or raise ValueError if it has not been added."""
        self._on_set.remove(callback)

    def remove_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Remove a callback, or raise ValueError if it has not been added."""
        self._post_set.remove(callback)

    def _declare(self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool) -> list[Parameter]:
        declared: dict[str, ParameterDescriptor] = {}
        parameter_list = []
        for index, given in enumerate(parameters):
            name, default, descriptor = read_declaration(namespace, given, index, stacklevel=3)
            value = default if ignore_override else self._overrides.get(name, default)
            parameter_list.append(Parameter(name, value=value))
            declared[name] = descriptor
        if known := [parameter.name for parameter in parameter_list if parameter.name in self._parameters]:
            raise exceptions.ParameterAlreadyDeclaredException(known)
        for parameter in parameter_list:
            name, descriptor = parameter.name, declared[parameter.name]
            reason = refusal(parameter, descriptor, self.has_parameter(name))
            if reason.startswith("Wrong parameter type"):
                raise exceptions.InvalidParameterTypeException(parameter, Parameter.Type(descriptor.type).name)
            result = SetParametersResult(reason=reason) if reason else self._set([parameter], declared)
            if not result.successful:
                raise exceptions.InvalidParameterValueException(name, parameter.value, result.reason)
        return [self._parameters[parameter.name] for parameter in parameter_list]

    def _set_all(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Run the pre-set callbacks, check the parameters, and set them only if all of them are allowed."""
        if self._pre_set:
            parameter_list = [parameter for callback in self._pre_set for parameter in callback(parameter_list)]
            if not parameter_list:
                return SetParametersResult(successful=False, reason=EMPTIED)
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = [parameter.name for parameter in parameter_list if parameter.name not in self._parameters]
        if undeclared:
            self._require_undeclared_allowed(undeclared)
        for parameter in parameter_list:
            if reason := self._refusal(parameter):
                return SetParametersResult(successful=False, reason=reason)
        return self._set(parameter_list)

    def _refusal(self, parameter: Parameter) -> str:
        """Return why a declared parameter cannot be set to a value, or "" if it can."""
        descriptor = self._descriptors.get(parameter.name)
        if descriptor is None:
            return ""
        if descriptor.read_only:
            return f"Trying to set a read-only parameter: {parameter.name}."
        return refusal(parameter, descriptor, is_declared=True)

    def _set(
        self, parameter_list: list[Parameter], declared: dict[str, ParameterDescriptor] | None = None
    ) -> SetParametersResult:
        """Set parameters unless a callback rejects them. They have already been checked against their descriptors.

        Args:
            parameter_list: the parameters.
            declared: the parameters' descriptors, if this call declares the parameters; otherwise None.
        """
        for check in tuple(self._on_set):
            result = check(parameter_list)
            if not result.successful:
                return result
        event = ParameterEvent()
        for parameter in parameter_list:
            self._changes(event, parameter, declared is not None).append(parameter.to_parameter_msg())
            if parameter.type_ == Parameter.Type.NOT_SET and declared is None:
                self._forget(parameter.name)
                continue
            self._parameters[parameter.name] = parameter
            if declared is not None:
                self._descriptors[parameter.name] = declared[parameter.name]
            else:
                self._descriptors.setdefault(parameter.name, ParameterDescriptor(dynamic_typing=True))
            if parameter.name == "use_sim_time" and isinstance(parameter.value, bool):
                self._use_sim_time(parameter.value)
        self._publish_parameter_event(event)
        for callback in tuple(self._post_set):
            callback(parameter_list)
        return SetParametersResult(successful=True)

    def _changes(self, event: ParameterEvent, parameter: Parameter, is_declared_now: bool) -> list[ParameterMessage]:
        """Return the event's list that this change belongs in: new, changed or deleted parameters.

        Call this method before you set the parameter.
        """
        if parameter.type_ == Parameter.Type.NOT_SET and not is_declared_now:
            changes = event.deleted_parameters
        elif self.get_parameter_or(parameter.name).type_ == Parameter.Type.NOT_SET:
            changes = event.new_parameters
        else:
            changes = event.changed_parameters
        return changes  # type: ignore[no-any-return]

    def _forget(self, name: str) -> None:
        self._parameters.pop(name, None)
        self._descriptors.pop(name, None)

    def _require_undeclared_allowed(self, name: str | list[str]) -> None:
        if not self._allow_undeclared:
            raise exceptions.ParameterNotDeclaredException(name)


def _strings(names: Sequence[str]) -> Sequence[str]:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")
    return names
