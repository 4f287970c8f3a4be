% The oracle's lines (spec/oracle.md) for an implementation in Octave. jsondecode gets the last place of numbers wrong, and
% cannot tell [1] from 1: so numbers are made texts before, "#0.1" for 0.1. It also keeps the last of two equal keys.
1;

function refuse_if(condition, code, message)
  if condition, error(["oracle:" code], "%s", message); end
end

% ---- Readers of arguments ----

function x = number(x)
  refuse_if(!ischar(x), "bad_argument", "expected a number");
  x = numbers({x});
end

function x = positive(x)
  x = number(x);
  refuse_if(x <= 0, "out_of_range", "a number is not above 0");
end

function x = not_negative(x)
  x = number(x);
  refuse_if(x < 0, "out_of_range", "a number is below 0");
end

function p = probability(p)
  p = number(p);
  refuse_if(p <= 0 || p >= 1, "out_of_range", "a probability is not between 0 and 1");
end

function s = word(s)
  refuse_if(!ischar(s), "bad_argument", "expected a text");
end

function v = numbers(v)
  refuse_if(!iscell(v) && !isempty(v) || !all(strncmp(v, "#", 1)), "bad_argument", "expected a list of numbers");
  v = str2double(strrep(v, "#", ""));
  refuse_if(!all(isfinite(v)), "bad_argument", "a number is too large");
end

function v = samples(v)
  v = numbers(v);
  refuse_if(isempty(v), "bad_argument", "expected numbers");
end

function v = knots(v)
  v = numbers(v);
  refuse_if(numel(v) < 2 || any(diff(v) <= 0), "out_of_range", "an axis does not increase");
end

% Of lists of one length; of none, too.
function m = matrix(m)
  refuse_if(!iscell(m) && !isempty(m), "bad_argument", "expected a list of lists");
  if isempty(m), m = {}; end
  lists = cellfun(@samples, m, "UniformOutput", false);
  same_length(lists{:});
  m = [zeros(1, 0), lists{:}]';
end

function same_length(varargin)
  refuse_if(any(diff(cellfun(@numel, varargin))), "bad_argument", "lengths differ");
end

% ---- Requests and answers ----

function ok = answer(op, args)
  ops = all_ops();
  if strcmp(op, "capabilities")
    ok = struct("version", ["Octave " version()], "ops", {fieldnames(ops)});
    return
  end
  refuse_if(!any(strcmp(op, fieldnames(ops))), "unknown_op", "no such op");
  refuse_if(!isstruct(args) || !isscalar(args), "bad_argument", "args is expected to be an object");
  readers = ops.(op);
  if strcmp(op, "threshold")
    refuse_if(!isfield(args, "criterion"), "bad_argument", "no criterion");
    readers = threshold_arguments(args.criterion); op = ["threshold_" args.criterion];
  end
  pairs = reshape(strsplit(readers, " "), 2, []);
  refuse_if(!isempty(setxor(pairs(2, :), fieldnames(args)')), "bad_argument", "an argument is missing or unknown");
  for pair = pairs, args.(pair{2}) = feval(pair{1}, args.(pair{2})); end
  ok = feval(op, args);
end

function s = encode(value)
  if isstruct(value)
    s = ["{" strjoin(cellfun(@(k) [encode(k) ":" encode(value.(k))], fieldnames(value)', "UniformOutput", false), ",") "}"];
  elseif iscell(value)
    s = ["[" strjoin(cellfun(@encode, value(:)', "UniformOutput", false), ",") "]"];
  elseif ischar(value)
    s = jsonencode(value); % of numbers it would write five digits
  else
    refuse_if(!isfinite(value), "overflow", "the answer is no finite number");
    s = sprintf("%.17g", value);
  end
end

function s = reply(line)
  id = "null";
  try
    depth = max(cumsum((line == "[" | line == "{") - (line == "]" | line == "}")));
    refuse_if(depth > 100 || !strncmp(line, "{", 1), "bad_json", "no object, or nested too deeply");
    keys = regexp(line, '"(\w*)"\s*:', "tokens");
    refuse_if(numel(unique([keys{:}])) < numel(keys), "bad_request", "a key stands twice");
    refuse_if(!isempty(strfind(line, '\u0000')), "bad_json", "a text with a zero");
    tagged = '([\[,:]\s*)(-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][-+]?[0-9]+)?)(?=\s*[\],}])';
    request = jsondecode(regexprep(line, tagged, '$1"#$2"'));
    refuse_if(!all(isfield(request, {"id", "op"})) || !ischar(request.id), "bad_request", "expected an object with id and op");
    id = encode(request.id);
    if id(2) == "#", id = id(3:end - 1); end
    refuse_if(!isempty(setdiff(fieldnames(request), {"id", "op", "args"})), "bad_request", "an unknown key");
    if !isfield(request, "args"), request.args = []; end
    s = sprintf('{"id":%s,"ok":%s}', id, encode(answer(request.op, request.args)));
  catch problem
    s = sprintf('{"id":%s,"error":{"code":"refused","message":%s}}', id, encode(problem.message));
  end
end

function answer_lines()
  while true
    try
      line = input("", "s"); % fgetl would wait for the line after
    catch
      break
    end
    puts([reply(line) "\n"]);
    fflush(stdout);
  end
end
