#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one page per public header from the XML that Doxygen makes of it.

Usage: cpp_reference.py XML_FOLDER FOLDER
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

xml, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def words(element):
    """Text of a paragraph as reStructuredText."""
    text = (element.text or "").replace("\\", "\\\\").replace("*", "\\*").replace("|", "\\|").replace("`", "\\`")
    text = text.replace("_ ", "\\_ ")
    for child in element:
        if child.tag == "computeroutput":
            text += "``" + "".join(child.itertext()).strip() + "``"
        elif child.tag == "emphasis":
            text += "*" + "".join(child.itertext()).strip() + "*"
        elif child.tag not in ("itemizedlist", "orderedlist", "simplesect", "parameterlist", "programlisting", "verbatim"):
            text += words(child)
        text += (child.tail or "").replace("\\", "\\\\").replace("*", "\\*").replace("|", "\\|").replace("`", "\\`")
    return " ".join(text.split())


def prose(element):
    """Lines of a description: paragraphs, lists, code, parameters, what is returned."""
    lines = []
    for child in [] if element is None else element:
        if child.tag != "para":
            continue
        if words(child):
            lines += [words(child), ""]
        for part in child:
            if part.tag in ("itemizedlist", "orderedlist"):
                for item in part.findall("listitem"):
                    inner = [line for line in prose(item) if line]
                    lines += ["* " + inner[0], *["  " + line for line in inner[1:]]] if inner else []
                lines.append("")
            elif part.tag in ("programlisting", "verbatim"):
                code = [("".join((" " if e.tag == "sp" else "") + (e.text or "") + (e.tail or "") for e in line.iter()))
                        for line in part.iter("codeline")] if part.tag == "programlisting" else part.text.split("\n")
                lines += ["::", "", *["   " + line for line in code], ""]
            elif part.tag == "simplesect":
                kind = {"return": "Returns: ", "see": "See ", "note": "Note: "}.get(part.get("kind"), "")
                inner = [line for line in prose(part) if line]
                lines += [kind + " ".join(inner), ""]
            elif part.tag == "parameterlist":
                for item in part.findall("parameteritem"):
                    name = ", ".join(n.text for n in item.iter("parametername") if n.text)
                    lines += [f"* ``{name}``: " + " ".join(line for line in prose(item.find("parameterdescription")) if line)]
                lines.append("")
    return lines


def description(member):
    return prose(member.find("briefdescription")) + prose(member.find("detaileddescription"))


def indented(lines):
    return ["   " + line if line else "" for line in lines]


def template_of(member):
    parameters = member.find("templateparamlist")
    if parameters is None:
        return ""
    texts = []
    for parameter in parameters.findall("param"):
        text = "".join(parameter.find("type").itertext())
        for tag, before in (("declname", " "), ("defval", " = ")):
            found = parameter.find(tag)
            if found is not None:
                text += before + "".join(found.itertext())
        texts.append(text)
    return "template <" + ", ".join(texts) + "> "


def directive(kind, declaration, body):
    return [f".. cpp:{kind}:: {' '.join(declaration.split())}", "", *indented(body), ""]


def member_lines(member, scope):
    name = member.find("name").text
    kind = member.get("kind")
    if kind == "enum":
        body = description(member)
        for value in member.findall("enumvalue"):
            body += directive("enumerator", value.find("name").text, description(value))
        return directive("enum-class" if member.get("strong") == "yes" else "enum", scope + name, body)
    if kind == "typedef":
        type_text = "".join(member.find("type").itertext())
        return directive("type", f"{template_of(member)}{scope}{name} = {type_text}", description(member))
    type_element = member.find("type")
    type_text = "".join(type_element.itertext()).strip() if type_element is not None else ""
    if kind == "variable":
        value = member.find("initializer")
        text = "".join(value.itertext()).strip() if value is not None else ""
        if text and not text.startswith("="):
            text = "= " + text if text != "{}" else ""
        if "{." in text:  # designated initialisers are not in the grammar of Sphinx
            text = ""
        static = "static " if member.get("static") == "yes" and scope == "" else ""
        return directive("member", f"{static}{type_text} {scope}{name} {text}", description(member))
    if kind == "function":
        arguments = "".join(member.find("argsstring").itertext())
        static = "static " if member.get("static") == "yes" and scope == "" else ""
        explicit = "explicit " if member.get("explicit") == "yes" else ""
        declaration = f"{template_of(member)}{static}{explicit}{type_text} {scope}{name}{arguments}"
        return directive("function", declaration.replace(" =delete", " = delete").replace(" =default", " = default"),
                         description(member))
    return []


def class_lines(identifier, scope=""):
    compound = ElementTree.parse(xml / f"{identifier}.xml").getroot().find("compounddef")
    name = compound.find("compoundname").text
    kind = compound.get("kind")
    body = description(compound)
    for inner in compound.findall("innerclass"):
        if inner.get("prot") == "public":
            body += class_lines(inner.get("refid"), scope="inner")
    for section in compound.findall("sectiondef"):
        if section.get("kind", "").startswith("private") or section.get("kind", "").startswith("protected"):
            continue
        for member in section.findall("memberdef"):
            if member.get("prot") == "public" and (description(member) or member.get("kind") != "function"
                                                   or "delete" not in "".join(member.find("argsstring").itertext())):
                body += member_lines(member, "")
    title = name.split("::")[-1] if scope else name
    return directive("struct" if kind == "struct" else "class", template_of(compound) + title, body)


def header_page(compound, header):
    lines = [header, "=" * len(header), "", "``#include <" + header + ">``", "", *description(compound)]
    classes = [c for c in compound.findall("innerclass")]
    names = {c.text for c in classes}
    for inner in classes:
        if inner.text.rsplit("::", 1)[0] not in names and "::detail" not in inner.text and inner.get("prot") == "public":
            lines += class_lines(inner.get("refid"))
    for section in compound.findall("sectiondef"):
        for member in section.findall("memberdef"):
            qualified = member.find("qualifiedname")
            definition = qualified.text if qualified is not None else member.find("definition").text
            if member.get("kind") == "define" or "::detail::" in definition or not description(member):
                continue
            scope = definition.rsplit("::", 1)[0] + "::" if "::" in definition else ""
            lines += member_lines(member, scope)
    return lines


groups = {}
for entry in ElementTree.parse(xml / "index.xml").getroot().findall("compound"):
    if entry.get("kind") != "file" or not entry.find("name").text.endswith(".hpp"):
        continue
    compound = ElementTree.parse(xml / f"{entry.get('refid')}.xml").getroot().find("compounddef")
    header = compound.find("location").get("file").split("/include/")[-1]
    page = folder / header.replace(".hpp", ".rst")
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n".join(header_page(compound, header)) + "\n")
    groups.setdefault(str(pathlib.PurePath(header).parent), []).append(header)
if not groups:
    sys.exit(f"no header in {xml}")

index = ["C++ API", "=======", "", "One page per public header, from the comments in it. What each room of the libraries holds stands in",
         "``libfrac/README.md`` and ``libbacklash/README.md``; complete programs in ``tests/consumer``.", ""]
for group, headers in sorted(groups.items()):
    index += [f"{group}/", "-" * (len(group) + 1), "", ".. toctree::", "   :maxdepth: 1", "",
              *["   " + header.replace(".hpp", "") for header in sorted(headers)], ""]
(folder / "index.rst").write_text("\n".join(index))
