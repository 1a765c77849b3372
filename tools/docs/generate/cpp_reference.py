#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one page per public header from the XML that Doxygen makes of it.

Usage: cpp_reference.py XML_FOLDER FOLDER
"""
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

xml, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def escaped(text):
    return re.sub(r"([\\*|`])", r"\\\1", text or "")


def words(element):
    """Text of a paragraph as reStructuredText."""
    text = escaped(element.text)
    for child in element:
        if child.tag in ("computeroutput", "emphasis"):
            mark = "``" if child.tag == "computeroutput" else "*"
            text += mark + "".join(child.itertext()).strip() + mark
        else:
            text += words(child)
        text += escaped(child.tail)
    return text


def list_item(lines):
    lines = [line for line in lines if line]
    return ["* " + lines[0], *["  " + line for line in lines[1:]]] if lines else []


def block(part):
    """Lines of a part of a description that is no running text; None for one that is."""
    lines = []
    if part.tag in ("itemizedlist", "orderedlist"):
        for item in part.findall("listitem"):
            lines += list_item(prose(item))
    elif part.tag == "verbatim":
        lines += ["::", "", *["   " + re.sub(r"^ */// ?", "", line) for line in part.text.strip("\n").split("\n")]]
    elif part.tag == "simplesect":
        kind = {"return": "Returns: ", "see": "See ", "note": "Note: "}.get(part.get("kind"), "")
        lines += [kind + " ".join(line for line in prose(part) if line)]
    elif part.tag == "parameterlist":
        before = "Throws " if part.get("kind") == "exception" else ""
        for item in part.findall("parameteritem"):
            name = ", ".join(n.text for n in item.iter("parametername") if n.text)
            meaning = " ".join(line for line in prose(item.find("parameterdescription")) if line)
            lines += [f"* {before}``{name}``: {meaning}"]
    else:
        return None
    return [*lines, ""]


def prose(element):
    """Lines of a description: paragraphs, lists, columns, parameters, what is returned and thrown."""
    lines = []
    for paragraph in [] if element is None else element.findall("para"):
        text = escaped(paragraph.text)
        for part in paragraph:
            part_lines = block(part)
            if part_lines is None:
                holder = ElementTree.Element("holder")
                holder.append(part)
                text += words(holder)  # with the text that follows the part
            else:
                lines += [" ".join(text.split()), ""] if text.strip() else []
                lines += part_lines
                text = escaped(part.tail)
        lines += [" ".join(text.split()), ""] if text.strip() else []
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
    declaration = re.sub(r"(\d) '(\d)", r"\1'\2", " ".join(declaration.split()))  # Doxygen takes 1'000 apart
    return [f".. cpp:{kind}:: {declaration}", "", *indented(body), ""]


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


def header_page(compound, header, members):
    lines = [header, "=" * len(header), "", "``#include <" + header + ">``", "", *description(compound)]
    classes = [c for c in compound.findall("innerclass")]
    names = {c.text for c in classes}
    for inner in classes:
        if inner.text.rsplit("::", 1)[0] not in names and "::detail" not in inner.text and inner.get("prot") == "public":
            lines += class_lines(inner.get("refid"))
    for member in members:
        definition = member.find("qualifiedname").text
        if "::detail::" not in definition and description(member):
            lines += member_lines(member, definition.rsplit("::", 1)[0] + "::")
    return lines


def header_of(element):
    return element.find("location").get("file").split("/include/")[-1]


# Free functions, enumerations and the like are listed with their namespace, whichever header declares them.
entries = ElementTree.parse(xml / "index.xml").getroot().findall("compound")
free_members = {}
for entry in entries:
    if entry.get("kind") == "namespace":
        for member in ElementTree.parse(xml / f"{entry.get('refid')}.xml").getroot().iter("memberdef"):
            free_members.setdefault(header_of(member), []).append(member)

groups = {}
for entry in entries:
    if entry.get("kind") != "file" or not entry.find("name").text.endswith(".hpp"):
        continue
    compound = ElementTree.parse(xml / f"{entry.get('refid')}.xml").getroot().find("compounddef")
    header = header_of(compound)
    page = folder / header.replace(".hpp", ".rst")
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n".join(header_page(compound, header, free_members.get(header, []))) + "\n")
    groups.setdefault(str(pathlib.PurePath(header).parent), []).append(header)
if not groups:
    sys.exit(f"no header in {xml}")

index = ["C++ API", "=======", "", "One page per public header, from the comments in it. What each room of the libraries holds stands in",
         "``libfrac/README.md`` and ``libbacklash/README.md``; complete programs in ``tests/consumer``.", ""]
for group, headers in sorted(groups.items()):
    index += [f"{group}/", "-" * (len(group) + 1), "", ".. toctree::", "   :maxdepth: 1", "",
              *["   " + header.replace(".hpp", "") for header in sorted(headers)], ""]
(folder / "index.rst").write_text("\n".join(index))
