% h5read(FILE, DATASET, START, COUNT) of MATLAB for a column, START counted from 1.
function values = h5read(file, dataset, start, count)
  names = strsplit(dataset(2:end), '/');
  values = load('-hdf5', file).(names{1}).(names{2})(start:start + count - 1)(:);
end
