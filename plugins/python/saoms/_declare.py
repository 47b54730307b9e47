"""What a class declares, read from its file without running it."""
import ast
import difflib
import json
import os
import sys

INTEGERS = {"int8": (-2**7, 2**7 - 1), "int16": (-2**15, 2**15 - 1), "int32": (-2**31, 2**31 - 1),
            "int64": (-2**63, 2**63 - 1), "uint8": (0, 2**8 - 1), "uint16": (0, 2**16 - 1), "uint32": (0, 2**32 - 1),
            "uint64": (0, 2**64 - 1)}
FLOATS = {"float32", "float64"}
WRAPPERS = {"list": "sequence", "List": "sequence", "Sequence": "sequence", "Optional": "optional"}
TYPES = "bool, int, float, str, an integer or float of saoms such as `uint32`, an Enumeration, a message, a list or an Optional of these"


# Larger files are no modules that people write.
LARGEST = 4 << 20


class Fault(Exception):
    """A fault of the code, with its place."""

    def __init__(self, message, node=None, module=None, part="class", help=(), instead=()):
        super().__init__(message)
        self.message, self.node, self.module = message, node, module
        self.part, self.help, self.instead = part, list(help), list(instead)

    def finding(self):
        message = self.message
        if self.module is not None and self.node is not None:
            message = f"{self.module.file}:{self.node.lineno}:{self.node.col_offset + 1}: {message}"
        return {"part": self.part, "message": message, "help": self.help, "instead": self.instead}


def near(name, names):
    return difflib.get_close_matches(name, sorted(set(names)), 3)


def meant(name, names):
    found = near(name, names)
    return f"; did you mean `{found[0]}`?" if found else ""


class Module:
    """A module: its syntax tree, and what its names are."""

    known = {}

    def __init__(self, name, file, folders):
        self.name, self.file, self.folders = name, file, folders
        self.is_package = os.path.basename(file) == "__init__.py"
        try:
            if os.stat(file).st_size > LARGEST:
                raise Fault(f"`{file}` has more than {LARGEST} bytes", part="module")
            with open(file, "rb") as opened:
                tree = ast.parse(opened.read(), file)
        except (RecursionError, MemoryError):
            raise Fault(f"`{file}` is nested too deeply to be read", part="module")
        except SyntaxError as error:
            place = f"{file}:{error.lineno or 1}:{error.offset or 1}"
            raise Fault(f"{place}: {error.msg}", part="module")
        except (OSError, ValueError) as error:
            raise Fault(f"`{file}` cannot be read: {error}", part="module")
        self.classes, self.constants, self.imports = {}, {}, {}
        for node in flat(tree.body):
            if isinstance(node, ast.ClassDef):
                self.classes[node.name] = node
            elif isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
                self.constants[node.targets[0].id] = node.value
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None:
                self.constants[node.target.id] = node.value
            elif isinstance(node, ast.Import):
                for one in node.names:
                    if one.asname:
                        self.imports[one.asname] = (one.name, None)
                    else:
                        self.imports[one.name.split(".")[0]] = (one.name.split(".")[0], None)
            elif isinstance(node, ast.ImportFrom):
                source = self.absolute(node)
                for one in node.names:
                    self.imports[one.asname or one.name] = (source, one.name)

    def absolute(self, node):
        if not node.level:
            return node.module
        parts = self.name.split(".")
        parts = parts[:len(parts) - node.level + (1 if self.is_package else 0)]
        return ".".join(parts + ([node.module] if node.module else []))

    def resolve(self, node):
        """What a name is: `("saoms", name)`, a class as `(module, definition)`, or `(None, name)`."""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node = ast.parse(node.value, mode="eval").body
        if isinstance(node, ast.Name):
            return self.lookup(node.id)
        if isinstance(node, ast.Attribute) and isinstance(node.value, (ast.Name, ast.Attribute)):
            source = self.source_of(node.value)
            if source is not None:
                return self.member(source, node.attr)
        return None, None

    def source_of(self, node):
        if isinstance(node, ast.Name):
            source, name = self.imports.get(node.id, (None, None))
            return source if name is None else f"{source}.{name}"
        inner = self.source_of(node.value)
        return None if inner is None else f"{inner}.{node.attr}"

    def lookup(self, name, seen=()):
        if name in self.classes:
            return self, self.classes[name]
        if name in self.imports:
            source, member = self.imports[name]
            return self.member(source, member) if member is not None else (None, name)
        star = [source for source, member in self.imports.values() if member == "*"]
        return self.member(star[0], name) if star else (None, name)

    def member(self, source, name):
        if source in ("saoms", "typing", "collections.abc", "enum"):
            return ("saoms" if source == "saoms" else "typing"), name
        try:
            module = find(source, self.folders)[0]
        except Fault:
            return None, name
        return module.lookup(name) if name != "*" else (None, name)

    def constant(self, node):
        """The value of a literal, or of a name of the module for one."""
        if isinstance(node, ast.Name) and node.id in self.constants:
            node = self.constants[node.id]
        try:
            return ast.literal_eval(node)
        except (ValueError, TypeError, SyntaxError):
            raise Fault("expected a literal: the program reads it without running the file", node, self)


def flat(nodes):
    """Statements of a module, those below an `if` or `try` among them."""
    for node in nodes:
        if isinstance(node, (ast.If, ast.Try)):
            yield from flat(node.body)
            yield from flat(node.orelse)
        else:
            yield node


def find(name, folders):
    """A module, and whether it is one that is installed."""
    parts = name.split(".")
    if not all(part.isidentifier() for part in parts):
        raise Fault(f"`{name}` is no name of a module: expected names with dots between, without the ending `.py`",
                    part="module", instead=[name[:-3]] if name[:-3].isidentifier() and name.endswith(".py") else [])
    for place, folder in enumerate([*folders, *sys.path]):
        base = os.path.join(folder, *parts)
        for file in (os.path.join(base, "__init__.py"), base + ".py"):
            if os.path.isfile(file):
                installed = place >= len(folders)
                # What a composite of somebody else brings leads to no file elsewhere.
                if not installed and not os.path.realpath(file).startswith(os.path.join(os.path.realpath(folder), "")):
                    raise Fault(f"the module `{name}` is outside the folder `{folder}`, and is not read", part="module")
                stamp = os.stat(file).st_mtime_ns, os.stat(file).st_size
                known = Module.known.get((name, file, tuple(folders)))
                if known is None or known[0] != stamp:
                    known = Module.known[name, file, tuple(folders)] = stamp, Module(name, file, folders)
                return known[1], installed
    beside = []
    for folder in folders:
        try:
            beside += [entry[:-3] for entry in os.listdir(folder) if entry.endswith(".py")]
        except OSError:
            pass
    looked = ", ".join(f"`{os.path.join(folder, *parts)}.py`" for folder in folders)
    raise Fault(f"there is no module `{name}`", part="module", instead=near(name, beside),
                help=[f"looked for {looked}, and where Python finds modules (`PYTHONPATH`, a virtual environment)"])


class Reader:
    """The reader of one class."""

    def __init__(self, module, definition):
        self.module, self.definition = module, definition
        self.faults = []

    def lineage(self, module, definition, seen=()):
        """The class and those that it extends, the most general first, if it is a component."""
        found, is_component = [], False
        for base in definition.bases:
            source, target = module.resolve(base)
            if source == "saoms" and target == "Component":
                is_component = True
            elif isinstance(target, ast.ClassDef) and target not in seen:
                more, is_one = self.lineage(source, target, (*seen, target))
                found += [one for one in more if one not in found]
                is_component |= is_one
        return [*found, (module, definition)], is_component

    def declare(self, name):
        lineage, is_component = self.lineage(self.module, self.definition)
        if not is_component:
            raise Fault(f"the class `{self.definition.name}` is no component", self.definition, self.module,
                        help=[f"write `class {self.definition.name}(saoms.Component):`"])
        self.methods, fields = {}, {}
        for module, definition in lineage:
            for place, node in enumerate(definition.body):
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                    self.methods[node.name] = (module, node)
                elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                    after = definition.body[place + 1] if place + 1 < len(definition.body) else None
                    fields[node.target.id] = (module, node, text_of(after))
        result = {"contract": 1, "class": name, "kind": "periodic" if "execute" in self.methods else "passive",
                  "doc": first_paragraph(ast.get_docstring(self.definition)), "apart": True, "properties": [],
                  "publishes": [], "subscribes": [], "services": [], "references": []}
        if "react" in self.methods:
            result["reacts"] = True
        self.result, self.bindings = result, {}
        for field, (module, node, doc) in fields.items():
            if field.startswith("_"):
                continue
            try:
                self.field(module, field, node, doc)
            except Fault as fault:
                self.faults.append(fault)
        return result

    def field(self, module, field, node, doc):
        annotation = unquoted(node.annotation)
        outer, inner = split(annotation)
        source, target = module.resolve(outer)
        call, options = self.call(module, node.value)
        if source == "saoms" and target in ("Publisher", "Subscription"):
            return self.topic(module, field, node, target, inner, call, options)
        if source == "saoms" and target == "Service":
            return self.service(module, field, node, inner)
        if source == "typing" and target == "ClassVar" or source == "saoms" and target == "Context":
            return None
        kind, element = self.wrapper(module, outer, inner)
        wrapped = module.resolve(unquoted(element)) if kind else (source, target)
        if isinstance(wrapped[1], ast.ClassDef) and is_interface(*wrapped):
            reference = {"name": field, "interface": self.interface(*wrapped)}
            if kind == "optional":
                reference["optional"] = True
            if kind == "sequence":
                reference.update(optional=True, many=True)
            self.result["references"].append(reference)
            self.bindings[field] = "reference"
            return None
        return self.property(module, field, node, doc, call, options)

    def call(self, module, node):
        """The function of saoms that a value calls, and its arguments."""
        if not isinstance(node, ast.Call):
            return None, {}
        source, target = module.resolve(node.func)
        if source != "saoms":
            return None, {}
        first = {"property": "default", "state": "topic", "event": "topic"}.get(target, "value")
        options = {first: module.constant(one) for one in node.args[:1]}
        options.update({one.arg: module.constant(one.value) for one in node.keywords if one.arg})
        return target, options

    def topic(self, module, field, node, role, inner, call, options):
        if call not in ("state", "event") or "topic" not in options:
            raise Fault(f"`{field}` names no topic: write `= saoms.state(\"TOPIC\")` or `= saoms.event(\"TOPIC\")` behind it",
                        node, module)
        source, target = module.resolve(unquoted(inner))
        if not isinstance(target, ast.ClassDef) or not is_message(source, target):
            raise Fault(f"the messages of `{field}` are of `{ast.unparse(inner)}`, expected a class with "
                        "`@saoms.message`", inner, module)
        schema = self.message(source, target)
        topic = {"topic": options["topic"], "kind": call, "message": schema["name"], "schema": schema}
        if options.get("optional"):
            topic["optional"] = True
        speaker = decorated(source, target, "message").get("speaker")
        if speaker:
            topic["speakers"] = [{"field": speaker}]
        which = "publishes" if role == "Publisher" else "subscribes"
        self.result[which].append(topic)
        self.bindings[field] = (which, topic)
        return None

    def service(self, module, field, node, inner):
        source, target = module.resolve(unquoted(inner))
        if not isinstance(target, ast.ClassDef) or not is_interface(source, target):
            raise Fault(f"the service `{field}` has the interface `{ast.unparse(inner)}`, expected a class that extends "
                        "`saoms.Interface`", inner, module)
        interface = self.interface(source, target)
        for operation in interface["operations"]:
            name = operation["name"]
            if name not in self.methods:
                raise Fault(f"the service `{field}` needs a method `{name}`{meant(name, self.methods)}", node, module)
            own = self.operation(*self.methods[name])
            if own != operation:
                raise Fault(f"the method `{name}` of the service `{field}` has other arguments or another reply than "
                            f"its interface `{target.name}`", self.methods[name][1], self.methods[name][0])
        self.result["services"].append({"name": field, "interface": interface})
        self.bindings[field] = "service"

    def interface(self, module, definition):
        names = [module.constant(one.value) for one in definition.keywords if one.arg == "name"]
        methods = [one for one in definition.body if isinstance(one, ast.FunctionDef) and not one.name.startswith("_")]
        return {"name": (names or [f"{module.name}.{definition.name}"])[0],
                "operations": [self.operation(module, one) for one in methods]}

    def operation(self, module, method):
        arguments = []
        for one in method.args.args[1:]:
            if one.annotation is None:
                raise Fault(f"the argument `{one.arg}` has no annotation", one, module)
            arguments.append({"name": one.arg, "type": self.type(module, one.annotation)})
        reply = method.returns
        is_none = reply is None or isinstance(reply, ast.Constant) and reply.value is None
        return {"name": method.name, "arguments": arguments, "reply": None if is_none else self.type(module, reply)}

    def message(self, module, definition):
        options = decorated(module, definition, "message")
        fields = []
        for node in definition.body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                fields.append({"name": node.target.id, "type": self.type(module, node.annotation)})
        schema = {"name": options.get("name") or definition.name, "fields": fields}
        for option in ("key", "place"):
            if options.get(option):
                names = [one["name"] for one in fields]
                if options[option] not in names:
                    raise Fault(f"the {option} `{options[option]}` of the message `{definition.name}` is none of its "
                                f"fields{meant(options[option], names)}", definition, module)
                schema[option] = options[option]
        return schema

    def wrapper(self, module, outer, inner):
        """`sequence` or `optional`, and what it is of."""
        if isinstance(outer, ast.BinOp) and isinstance(outer.op, ast.BitOr):
            sides = [one for one in (outer.left, outer.right)
                     if not (isinstance(one, ast.Constant) and one.value is None)]
            return ("optional", sides[0]) if len(sides) == 1 else (None, None)
        source, target = module.resolve(outer)
        if inner is None or source not in (None, "typing"):
            return None, None
        return WRAPPERS.get(target), inner

    def type(self, module, annotation):
        """The type of a field."""
        annotation = unquoted(annotation)
        outer, inner = split(annotation)
        kind, element = self.wrapper(module, outer, inner)
        if kind:
            return {kind: self.type(module, element)}
        source, target = module.resolve(outer)
        if isinstance(target, ast.ClassDef):
            if is_message(source, target):
                return self.message(source, target)
            if is_enumeration(source, target):
                of = decorated(source, target, "enumeration").get("value", "uint8")
                values = {node.targets[0].id: source.constant(node.value) for node in target.body
                          if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)}
                return {"enumeration": of, "values": values}
        elif source == "saoms":
            if target in INTEGERS or target in FLOATS:
                return target
            if target == "Time":
                return "time"
        elif source is None and inner is None:
            simple = {"bool": "bool", "int": "int64", "float": "float64", "str": "string"}.get(target)
            if simple:
                return simple
        raise Fault(f"`{ast.unparse(annotation)}` is no type of a message: expected {TYPES}"
                    f"{meant(ast.unparse(outer), [*INTEGERS, *FLOATS, 'bool', 'int', 'float', 'str'])}", annotation, module)

    def property(self, module, field, node, doc, call, options):
        annotation = unquoted(node.annotation)
        outer, inner = split(annotation)
        if call not in (None, "property"):
            raise Fault(f"`{field}` is no topic: annotate it with `saoms.Publisher[...]` or `saoms.Subscription[...]`",
                        node, module)
        if node.value is not None and call is None:
            options = {"default": module.constant(node.value)}
        one = {"name": options.get("name", field)}
        kind, element = self.wrapper(module, outer, inner)
        if kind == "sequence":
            one["many"] = True
            outer, inner = split(unquoted(element))
        source, target = module.resolve(outer)
        if source == "saoms" and target in INTEGERS or source is None and target == "int":
            one["type"] = "integer"
            one["min"], one["max"] = INTEGERS[target if source else "int64"]
        elif source == "saoms" and target in FLOATS or source is None and target == "float":
            one["type"] = "float"
        elif source == "saoms" and target == "Duration":
            one["type"] = "duration"
        elif source is None and target in ("bool", "str"):
            one["type"] = {"bool": "boolean", "str": "string"}[target]
        elif source == "typing" and target == "Literal":
            parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
            one["type"], one["allowed"] = "string", [module.constant(part) for part in parts]
        else:
            raise Fault(f"`{field}` has the type `{ast.unparse(annotation)}`, expected a topic, a service, a reference, or "
                        f"a property of the type bool, int, float, str, Duration, Literal or `uint32` and the like"
                        f"{meant(ast.unparse(outer).split('.')[-1], [*INTEGERS, *FLOATS, 'bool', 'int', 'float', 'str', 'Publisher', 'Subscription', 'Service', 'Duration', 'Literal'])}",
                        node.annotation, module)
        for option in ("min", "max", "unit", "allowed"):
            if options.get(option) is not None:
                one[option] = options[option]
        for option, name in (("live", "live"), ("non_empty", "nonEmpty"), ("speaker", "speaker")):
            if options.get(option):
                one[name] = True
        if options.get("doc") or doc:
            one["doc"] = options.get("doc") or doc
        default = options.get("default")
        if default is not None and not one.get("many"):
            is_time = one["type"] == "duration" and not isinstance(default, str)
            one["default"] = written(default) + ("s" if is_time else "")
        elif default is None and not one.get("many"):
            one["required"] = True
        self.result["properties"].append(one)
        self.bindings[field] = ("property", one)


def written(value):
    return {True: "true", False: "false"}[value] if isinstance(value, bool) else str(value)


def unquoted(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        try:
            inner = ast.parse(node.value, mode="eval").body
        except SyntaxError:
            return node
        return ast.copy_location(inner, node)
    return node


def split(node):
    """`list[T]` is `list` of `T`."""
    if not isinstance(node, ast.Subscript):
        return node, None
    return node.value, getattr(node.slice, "value", node.slice) if type(node.slice).__name__ == "Index" else node.slice


def text_of(node):
    """The text that stands behind an annotation documents it."""
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    return " ".join(node.value.value.split()) if is_text else ""


def first_paragraph(text):
    return " ".join((text or "").split("\n\n")[0].split())


def decorated(module, definition, name):
    """The arguments of a decorator of saoms; `None` where the class does not have it."""
    for one in definition.decorator_list:
        call = one.func if isinstance(one, ast.Call) else one
        if module.resolve(call) == ("saoms", name):
            if not isinstance(one, ast.Call):
                return {}
            options = {"value": module.constant(given) for given in one.args[:1]}
            options.update({given.arg: module.constant(given.value) for given in one.keywords if given.arg})
            return options
    return {}


def is_message(module, definition):
    return any(module.resolve(one.func if isinstance(one, ast.Call) else one) == ("saoms", "message")
               for one in definition.decorator_list)


def is_enumeration(module, definition):
    return any(module.resolve(base) == ("saoms", "Enumeration") for base in definition.bases)


def is_interface(module, definition):
    return any(module.resolve(base) == ("saoms", "Interface") for base in definition.bases)


def read(request):
    """The module, its reader after it has declared the class, and whether the module is installed."""
    module, installed = find(request["module"], request["folders"])
    definition = module.classes.get(request["class"])
    if definition is None:
        raise Fault(f"`{module.file}` has no class `{request['class']}`", instead=near(request["class"], module.classes),
                    help=[f"its classes are {', '.join(f'`{one}`' for one in module.classes)}"] if module.classes else
                    ["it has none"])
    reader = Reader(module, definition)
    reader.declare(f"{request['module']}.{request['class']}")
    return module, reader, installed


def declare(text):
    """The answer to a request of the program."""
    try:
        module, reader, installed = read(json.loads(text))
    except Fault as fault:
        return json.dumps({"declaration": None, "findings": [fault.finding()]})
    except RecursionError:
        fault = Fault("the class, or a message or module that it uses, contains itself")
        return json.dumps({"declaration": None, "findings": [fault.finding()]})
    if reader.faults:
        return json.dumps({"declaration": None, "findings": [one.finding() for one in reader.faults]})
    return json.dumps({"declaration": reader.result, "file": module.file, "installed": installed, "findings": []})
