"""What words say of a shape: that nobody may fly there, that one must stay inside, or which role it has.

Names, folders, documents and values of other programs are free text in any language. Words that restrict are
looked for anywhere in a text, by their stems: one that is found wrongly costs a question, one that is missed
an incursion. Words for the other roles have to be all that the text says.
"""

from __future__ import annotations

import contextlib
import html
import re
import sys
import unicodedata
from collections.abc import Iterator
from functools import lru_cache
from urllib.parse import unquote

#: Stems that begin a word, by language; blanks stand for blanks, hyphens, underscores and changes of case.
_FORBID = (
    # English
    r"no ?fly\w*|no ?flight\w*|no ?flying|no ?over ?fl\w*|no ?drone\w*|no ?uav\w*|no ?uas\b|no ?suas\b"
    r"|no ?rpas\b"
    r"|no ?go\b|no ?entry|no ?access|no ?trespass\w*|not? (?:to )?(?:fly|enter|overfly|cross)\w*"
    r"|(?:dont|don t|never) (?:fly|enter|overfly|cross)\w*|restrict\w*|prohibit\w*|forbid\w*|ban|bans"
    r"|banned"
    r"|off limits?|out of bounds|keep ?out|stay ?out|stay clear|keep clear|stand ?off|avoid\w*|exclu\w*"
    r"|danger\w*|hazard\w*|warning (?:area|zone)\w*|alert area\w*|firing (?:area|range|zone)\w*|live fire"
    r"|military (?:area|zone|airspace)\w*|controlled (?:airspace|zone|area)\w*|control (?:zone|area)\w*"
    r"|req authori[sz]ation|authori[sz]ation required|permission required|denied"
    r"|closed (?:airspace|area|zone)\w*|not allowed|not permitted|unsafe|excl|blocked|out of limits?",
    # abbreviations of air traffic
    r"nfz\w*|ctr|mctr|ctz|atz|frz|rpz|tfrs?|koz|adiz|nofly\w*|ed r|ed p|ed d",
    # German
    r"\w*verbot\w*|\w*verbuet\w*|kein\w* (?:uber)?fl[iu]\w*"
    r"|flugbeschrank\w*|luftsperr\w*|\w*sperrgebiet\w*|sperr\w*|\w*gefahr\w*|kontrollzone\w*"
    r"|nicht (?:uber|be)?flieg\w*|ausschluss\w*|meid\w*"
    r"|\w*gesperrt\w*|\w*flugsperr\w*|\w*sperrb(?:ezirk|ereich)\w*",
    # French
    r"interdi\w*|reglement\w*|danger\w*|survol interdit|zones? (?:p|r|d)\b|eviter|evitement"
    r"|hors limites?|defendu\w*|(?:ne pas|non) (?:survol\w*|voler|entrer)|pas de survol|zit|zrt",
    # Italian, Spanish, Portuguese, Catalan, Romanian
    r"viet\w*|divieto\w*|interdet\w*|regolamentat\w*|pericol\w*|riservat\w*|prohib\w*|proib\w*|restring\w*"
    r"|restrit\w*|restric\w*|peligr\w*|perig\w*|vedad\w*|no vol\w*|no sobrevol\w*|evitar\w*|interzis\w*"
    r"|interzic\w*"
    r"|no vuel\w*|sin vuelo\w*|non (?:vol\w*|sorvol\w*|entrare)|nao (?:voar|sobrevo\w*|entrar)|sem voo\w*",
    # Dutch, Scandinavian, Finnish
    r"verboden|verbode|vl[iu]e?gverbod\w*|bannsv\w*|flugbann\w*|beperk\w*|gevaar\w*|forbud\w*|forbudt|forbjud\w*|flygforbud\w*|flyveforbud\w*"
    r"|flyforbud\w*|restrik\w*|farlig\w*|fareomrad\w*|kielle\w*|kielto\w*|lentokiel\w*|rajoit\w*|vaara\w*"
    r"|geen vlieg\w*|niet (?:vliegen|betreden)|ikke fly\w*|flyg ej|flyv ikke|ei saa",
    # Polish, Czech, Slovak, Slovene, Croatian, Hungarian, Turkish, Baltic
    r"zakaz\w*|zabron\w*|ogranicz\w*|niebezp\w*|omezen\w*|obmedzen\w*|nebezp\w*|zabran\w*|omejit\w*"
    r"|prepoved\w*"
    r"|ogranicen\w*|opasn\w*|zabranj\w*|tilos\w*|tilalom\w*|tilalm\w*|tiltott\w*|korlatoz\w*|veszely\w*|yasak\w*|kisitl\w*|tehlike\w*"
    r"|draudz\w*|ribojim\w*|aizlieg\w*|ierobezo\w*|keelat\w*|\w*keelu\w*|qadagan\w*|taqiqla\w*"
    r"|ndaluar\w*|ndalohet|ndalim\w*|piirang\w*|ohtlik\w*"
    r"|bezlet\w*|neleta\w*|nie (?:lata\w*|wlat\w*)|\w*keeld|ucus yasag\w*|yasag\w*",
    # Indonesian, Malay, Vietnamese, Filipino, Swahili, Basque, Irish, Welsh, Maltese
    r"larang\w*|terlarang\w*|dilarang\w*|cam bay|(?:vung|khu vuc|khu) cam|han che|nguy hiem|bawal\w*"
    r"|mamnuuc\w*|malpermes\w*"
    r"|marufuku|hairuhusiwi|debeka\w*|toirmisc\w*|cosctha|dim hedfan|gwahardd\w*|projbit\w*"
    r"|jangan terbang|khong bay",
    # Restrictions, limits and what is not permitted, in the languages above
    r"\w*(?:be|ein)schrank\w*|schutzzone\w*|tabuzone\w*|\w*untersagt\w*"
    r"|(?:nicht |un)erlaubt\w*|nicht gestattet"
    r"|begrans\w*|begrens\w*|begraens\w*|inskrank\w*|\w*forbud\w*|dron\w* ?(?:fri|free|vrij)\w*|vliegvrij\w*"
    r"|(?:ikke|ej|inte) til\w*|niet toegestaan|unfly\w*|(?:not |un)authori[sz]ed|restrein\w*|defense de \w+"
    r"|(?:non|pas) autoris\w*|vol limite\w*|restrizion\w*|ristrett\w*|limitazion\w*"
    r"|non (?:autorizz|consentit|permess)\w*|(?:no|nao) (?:autoriz|permit)\w*|limitaci?on\w*|limitacao"
    r"|zona limitada|ei sallit\w*|nie wolno|niedozwol\w*|nepovol\w*|nedovol\w*|nedozvol\w*|nem engedely\w*"
    r"|izin yok|izinsiz\w*|sekatan|не ?разреш\w*|нельзя|недоступ\w*|не ?дозвол\w*|δεν επιτρεπ\w*",
    # Russian, Ukrainian, Bulgarian, Serbian, Greek
    r"запрет\w*|запрещ\w*|ограничен\w*|опасн\w*|бесполет\w*|заборон\w*|обмежен\w*|небезпеч\w*|забран\w*|забрањ\w*"
    r"|(?:не|нельзя) (?:лета|влета|літа|заліта)\w*|закрыт\w*|закрит\w*"
    r"|тыиым\w*|хориот\w*|хориг\w*"
    r"|απαγορ\w*|περιορισ\w*|επικινδυν\w*",
)  # fmt: skip
#: Of languages that put no blanks between words, or put endings before them: anywhere.
_FORBID_ANYWHERE = (
    "不允许", "不允許", "不准", "不许", "严禁", "嚴禁", "不許可", "不得", "禁制", "危険",
    "허용 안", "허가 필요", "غير مسموح",
    "禁飞", "禁飛", "禁航", "限航", "限飞", "限飛", "禁止", "禁区", "禁區", "限制",
    "限高", "管制", "管控", "危险", "危險", "净空", "淨空",
    "勿飞", "勿飛", "勿入", "不可飞", "不可飛", "飛行不可", "不得飞", "비행불가",
    "عدم الطيران", "منع الطيران", "איסור", "งดบิน",
    "नो फ्लाई", "नो-फ्लाई",
    "飛行禁止", "制限", "規制", "立入禁止", "비행금지", "금지", "제한", "위험", "관제권", "통제",
    "ممنوع", "محظور", "حظر", "خطر", "مقيد", "ממנוע", "אסור", "מסוכן", "מוגבל", "ห้าม", "จำกัด", "อันตราย",
    "निषिद्ध", "निषेध", "प्रतिबंध", "वर्जित", "मनाही", "बंदी", "খতরা", "নিষিদ্ধ", "নিষেধ", "தடை",
    "నిషేధ", "నిషిద్ధ", "ನಿಷೇಧ", "ನಿಷಿದ್ಧ", "നിരോധ", "નિષેધ", "પ્રતિબંધ", "ਮਨਾਹੀ", "ਵਰਜਿਤ", "තහනම්",
    "ຫ້າມ", "ហាម", "တားမြစ်", "የተከለከለ", "ክልክል", "نو فلائی", "نوفلائی", "قدغن", "აკრძალ",
    "სახიფათო", "արգել", "վտանգ", "ክልከላ", "ခွင့်မပြု", "ပိတ်ပင်",
)  # fmt: skip
_NEGATION = r"(?:no|non|not|without|free of|keine?|ohne|nicht|sans|sin|sem|senza|bez|без)"
_NEGATED = re.compile(
    rf"\b{_NEGATION} (?:restric\w*|restrik\w*|prohibit\w*|hazard\w*|danger\w*|exclu\w*|beschrank\w*"
    r"|einschrank\w*|restrein\w*|restrizion\w*|limitazion\w*|limitaci?on\w*|begrans\w*|begrens\w*)"
)
_FORBIDDEN = re.compile(rf"\b(?:{'|'.join(_FORBID)})\b")
_ANYWHERE = re.compile("|".join(unicodedata.normalize("NFKC", word) for word in _FORBID_ANYWHERE))
_INSIDE = re.compile(
    r"\b(?:inclusion\w*|keep ?in\b|stay ?in\b|stay inside|"
    r"(?:operat\w*|flight|flying|mission) (?:area|zone|volume|geography|boundary)\b|area of operations?)"
)
#: What one must stay inside of, or out of: the word alone does not say.
_EITHER = re.compile(
    r"\b(?:geo ?fenc\w*|fenc(?:e|es|ing)|d ?fence|geo ?zones?|geographical zones?|airspaces?"
    r"|luftraum\w*|clotur\w*"
    r"|conditional|cta|tma|u ?space|moa|tsa|rmz|tmz|dra ?[iprtu]"
    # where states restrict flights: near airfields, over prisons, reserves, plants, the military
    r"|air ?ports?|aerodrom\w*|air ?fields?|air ?bases?|air ?strips?|(?:heli|verti) ?(?:ports?|pads?)"
    r"|flugplatz\w*|flughafen\w*|aeroport\w*|aeropuert\w*|eliport\w*|helipuert\w*|lufthavn\w*|flygplats\w*"
    r"|flyplass\w*|lentoasema\w*|lotnisk\w*|letist\w*|repuloter\w*|havaliman\w*|аэро(?:порт|дром)\w*"
    r"|аеро(?:порт|дром)\w*|military|militar\w*|militair\w*|prisons?|jails?|gefangnis\w*|nature reserves?"
    r"|(?:safety|buffer) zones?|zone sensible|zona sensible|zone de securite|zona de seguridad"
    r"|sicherheitszone\w*|protected areas?|schutzgebiet\w*|nesting|sua"
    r"|naturschutz\w*|national ?parks?|wildlife|bird sanctuar\w*|power ?plants?|nuclear|\w*kraftwerk\w*"
    r"|(?:max\w*|maximale?) (?:height|altitude|hohe)|hauteur max\w*|altura max\w*"
    r"|cerca virtual|geocerca\w*|geovall\w*)\b"
    r"|围栏|圍欄|空域|ジオフェンス|空域|공역|机场|機場|空港|공항|军事|軍事|监狱|監獄"
)
#: How states number prohibited, restricted and danger areas: EGD012, ED-R 37A, R-5503.
_DESIGNATOR = re.compile(
    r"(?:[A-Z]{2}[ -]?[RPD][ -]?\d{1,4}|DRA[ -]?[IPRTU][ -]?\d{1,4}|[RPDW]-\d{2,5})[A-Z]?(?![A-Za-z0-9])"
)
_THREATENS = re.compile(r"\b(?:threats?|missiles?|radars?|sams?|manpads?|aaa)\b")

#: What a text says, all of it, to mean a role; without a number behind.
_PHRASES = {
    "roi": (
        "roi", "rois", "region", "regions", "region of interest", "regions of interest", "target",
        "targets",
        "aoi", "area of interest", "areas of interest", "poi", "point of interest", "points of interest",
        "survey area", "survey areas",
    ),
    "threat": ("threat", "threats", "missile", "missiles", "radar", "radars", "sam"),
    "no_fly": ("no fly", "no fly zone", "no fly zones", "nfz", "restricted", "prohibited"),
    "obstacle": ("obstacle", "obstacles", "building", "buildings", "obstruction", "obstructions"),
    "area": ("area", "operating area", "area of operations", "inclusion", "inclusion zone"),
    "start": (
        "start", "start point", "take off", "takeoff", "take off point", "takeoff point", "take off site",
        "takeoff site", "launch", "launch site", "launch point", "launch pad", "to", "t o", "tol", "toal",
        "home", "home point", "home position", "home location", "rth", "startpunkt", "startplatz", "abflug",
        "decollage", "point de depart", "despegue", "decollo", "decolagem", "partenza", "salida", "взлет",
        "起飞点", "起飞", "起飛點", "离陆", "離陸", "이륙",
    ),
    "end": (
        "end", "landing", "lz", "landing site", "landing point", "landing zone", "land",
        "recovery", "recovery site",
        "landeplatz", "landung", "atterrissage", "aterrizaje", "atterraggio", "pouso", "посадка",
        "降落点", "着陸",
        "착륙",
    ),
    "base": ("base", "bases", "rally", "rally point", "rally points"),
    "importance": ("importance",),
}  # fmt: skip
ROLE_OF_PHRASE = {phrase: role for role, phrases in _PHRASES.items() for phrase in phrases}
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z](?!s(?![a-z]))[a-z])")
_NO_WORD = re.compile(r"[\W_]+")
_DIGITS = re.compile(r"(?<=[^\W\d_])(?=\d)|(?<=\d)(?=[^\W\d_])")
_PERCENT = re.compile(r"%[0-9A-Fa-f]{2}")
_SPACED_NFZ = re.compile(r"\bn f z\b")
_LETTERS = str.maketrans(
    {
        "ı": "i",
        "ł": "l",
        "Ł": "L",
        "ø": "o",
        "Ø": "O",
        "đ": "d",
        "Đ": "D",
        "æ": "ae",
        "Æ": "AE",
        "'": "",
        "’": "",
    }
)
#: Letters that look like another alphabet's: Cyrillic and Greek ones, and the Latin ones they look like.
_ALIKE = (
    "авеѕіјкмнорстухαβεικνορτυχ",
    "abesijkmhopctyxabeiknoptyx",
)
_TO_LATIN = str.maketrans(*_ALIKE)
_TO_CYRILLIC = str.maketrans("abesijkmhopctyx", "авеѕіјкмнорстух")
_OTHER_LETTERS = re.compile("[\u0370-\u03ff\u0400-\u052f]")
#: Signs that stand over letters; those of Indian scripts are letters themselves.
_ACCENTS = frozenset(c for c in map(chr, range(0x901)) if unicodedata.combining(c))
_FALSE = frozenset({"", "0", "0.0", "no", "n", "false", "f", "none", "null", "nan", "off", "nein", "non"})
_NO = frozenset(("no", "n", "false", "f", "off", "nein", "non"))
_PERMITS = re.compile(
    r"\b(?:allow\w*|permit\w*|permis\w*|authori[sz]\w*|flyable|erlaubt|autoris\w*|autorizad\w*|consentit\w*)\b"
    r"|\b(?:can|may|ok) ?(?:to )?fly\b|\bfly ?ok\b"
)
_FLIES = re.compile(r"\b(?:drones?|ua[sv]s?|suas|rpas|aircraft|over ?flights?|flights?|fly|flying|flug)\b")
_LONGEST, _OVERLAP = 20_000, 100


def plain(text: str) -> str:
    """``No-Fly_Zone 3`` and ``NoFlyZone3`` as ``no fly zone 3``: single blanks, no accents, no case."""
    return _plain(text[:_LONGEST])


# One text is asked for several kinds of words, and those of folders come again with every shape in them.
@lru_cache(maxsize=512)
def _plain(text: str) -> str:
    bare = text
    if not text.isascii():
        folded = unicodedata.normalize("NFKD", _seen(text))
        bare = unicodedata.normalize("NFC", _without(folded, _ACCENTS, ""))
        bare = bare.translate(_LETTERS)
    bare = _CAMEL.sub(" ", bare.replace("'", ""))
    bare = _NO_WORD.sub(" ", bare.casefold())
    return _SPACED_NFZ.sub("nfz", _DIGITS.sub(" ", bare)).strip()


def _pieces(text: str) -> Iterator[str]:
    """The whole text, a long one in parts that overlap by more than a phrase: what forbids may stand last."""
    yield text[:_LONGEST]
    for start in range(_LONGEST, len(text), _LONGEST):
        yield text[start - _OVERLAP : start + _LONGEST]


def forbids(text: str) -> str | None:
    """The word that forbids flying there; None where there is none."""
    return next(filter(None, map(_forbids, _pieces(text))), None)


def keeps_inside(text: str) -> str | None:
    """The word that means a fence to stay inside of."""
    return _keeps_inside(text[:_LONGEST])


def says_either(text: str) -> str | None:
    """A word of restriction that leaves open in which sense, or denies it."""
    return next(filter(None, map(_says_either, _pieces(text))), None)


def _without(text: str, characters: frozenset[str], instead: str) -> str:
    """The text with others for some characters, which few texts have."""
    if text.isascii() or characters.isdisjoint(text):
        return text
    return "".join(instead if c in characters else c for c in text)


@lru_cache(maxsize=1)
def _unseen() -> frozenset[str]:
    every = map(chr, range(sys.maxunicode + 1))
    return frozenset(c for c in every if unicodedata.category(c) == "Cf")


def _seen(text: str) -> str:
    """Without characters that are not seen: soft hyphens, joiners, marks of direction."""
    return _without(text, _unseen(), "")


def _readings(text: str) -> Iterator[str]:
    """The text, and what it may have been before another program wrote it down."""
    yield text
    if "&" in text or "<" in text:
        yield html.unescape(re.sub(r"<[^<>]*>", " ", text))
    if _PERCENT.search(text):
        yield unquote(text)
    if text.isascii():
        return
    for page in ("latin-1", "cp1252"):
        # UTF-8 that was read as a page of single bytes.
        with contextlib.suppress(UnicodeError):
            yield text.encode(page).decode("utf-8")
    spaced = _without(text, _unseen(), " ")
    if spaced != text:
        yield spaced
    bare = plain(text)
    if _OTHER_LETTERS.search(bare):
        # No word of these alphabets is made of look-alikes alone.
        yield bare.translate(_TO_LATIN)
        yield bare.translate(_TO_CYRILLIC)


@lru_cache(maxsize=512)
def _forbids(text: str) -> str | None:
    for reading in _readings(text):
        words = _NEGATED.sub(" ", plain(reading))
        found = _FORBIDDEN.search(words) or _ANYWHERE.search(unicodedata.normalize("NFKC", _seen(reading)))
        if found:
            return found.group().strip()
    return None


@lru_cache(maxsize=512)
def _keeps_inside(text: str) -> str | None:
    found = _INSIDE.search(plain(text))
    return found.group() if found else None


@lru_cache(maxsize=512)
def _says_either(text: str) -> str | None:
    found = _EITHER.search(plain(text)) or _NEGATED.search(plain(text)) or _DESIGNATOR.match(text.strip())
    return found.group() if found else None


def threatens(text: str) -> bool:
    """Whether the text speaks of missiles, radars or threats."""
    return _THREATENS.search(plain(text)) is not None


def role_of(text: str) -> str | None:
    """The role that the text means and nothing else, a number or a colon with more behind it aside."""
    head = plain(text.split(":", 1)[0])
    return ROLE_OF_PHRASE.get(head) or ROLE_OF_PHRASE.get(re.sub(r" \d+$", "", head))


def permits_not(key: str, value: str) -> bool:
    """Whether a value says no to what its name would permit: ``allowed=no``, ``drone=no``."""
    words, said = plain(key), value.strip().lower()
    if "requir" in words or "need" in words or _FORBIDDEN.search(words):
        return False
    if _PERMITS.search(words):
        return said in _NO or said in ("0", "0.0")
    return said in _NO and _FLIES.search(words) is not None


def is_false(text: str) -> bool:
    """Whether a value says no."""
    return text.strip().lower() in _FALSE
